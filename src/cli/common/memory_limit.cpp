#include "cli/common/memory_limit.h"

#include <sys/resource.h>

#include <algorithm>

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

}  // namespace

void add_memory_limit(CLI::App& app, std::size_t& bytes) {
  app.add_option("--max-memory", bytes, "Limit of memory, in bytes or as 512M, 4G; default: 4G")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->type_name("SIZE");
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
