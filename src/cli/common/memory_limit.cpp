#include "cli/common/memory_limit.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "core/parallel.h"

namespace polyrecon {
namespace {

std::size_t limit = 0;

/// Address space of the threads' stacks, which the system counts as data.
std::size_t stacks() {
  constexpr rlim_t usual = rlim_t{8} << 20;
  rlimit stack{};
  const bool known = ::getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur != RLIM_INFINITY;
  constexpr std::size_t libraries = 2;  // TBB's threads and those of the decoders
  return libraries * static_cast<std::size_t>(processors()) * (known ? stack.rlim_cur : usual);
}

/// The limit of the control group, as container and batch systems set it; the largest number where there is none.
std::size_t group_limit() {
  for (const char* path : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::size_t bytes = 0;
    if (std::ifstream(path) >> bytes) return bytes;
  }
  return std::numeric_limits<std::size_t>::max();
}

}  // namespace

std::size_t default_memory() {
  static constexpr std::size_t least = std::size_t{4} << 30;
  static const std::size_t memory = [] {
    const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGE_SIZE);
    if (pages <= 0 || page <= 0) return least;
    const std::size_t machine = static_cast<std::size_t>(pages) * static_cast<std::size_t>(page);
    return std::max(least, std::min(machine, group_limit()) / 2);
  }();
  return memory;
}

const char* const max_memory_help = "Limit of memory, in bytes or as 512M, 4G";
const char* const default_memory_text = "half of the machine's, at least 4G";

void add_memory_limit(CLI::App& app, std::size_t& bytes) {
  app.add_option("--max-memory", bytes, max_memory_help)
      ->transform(CLI::AsSizeValue(false).description(""))
      ->type_name("SIZE")
      ->default_str(default_memory_text);
}

void limit_memory(std::size_t bytes) {
  limit = bytes;
  rlimit data{};
  if (::getrlimit(RLIMIT_DATA, &data) != 0) return;
  data.rlim_cur = std::min<rlim_t>(data.rlim_max, bytes + stacks());
  ::setrlimit(RLIMIT_DATA, &data);
}

std::size_t memory_limit() { return limit; }

}  // namespace polyrecon
