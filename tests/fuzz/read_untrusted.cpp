#include "fuzz/read_untrusted.h"

#include <fstream>
#include <functional>

#include "io/inspect.h"
#include "polyrecon/error.h"
#include "polyrecon/merge.h"
#include "polyrecon/write_result.h"

namespace polyrecon::fuzz {
namespace {

constexpr std::size_t most_bytes = std::size_t{512} << 20;

void try_to(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    if (error.code() == ExitCode::Internal) throw;
  }
}

}  // namespace

void read_untrusted(const std::string& path, const std::string& folder) {
  ReadOptions options;
  options.limits.max_bytes = most_bytes;
  try_to([&] { inspect(path, options); });
  try_to([&] {
    const ReadResult in = read_frame(path, options);
    write_result(in.source, {{in.frame.beauty.name, in.frame.beauty.mean, false}}, folder + "/result.exr", {});
  });
  try_to([&] {
    const std::string copy = folder + "/copy.exr";
    // Not copy_file, which fails when the alarm signal of libFuzzer interrupts it.
    std::ofstream(copy, std::ios::binary) << std::ifstream(path, std::ios::binary).rdbuf();
    MergeOptions merging;
    merging.limits = options.limits;
    merge({path, copy}, folder + "/merged.exr", merging);
  });
}

}  // namespace polyrecon::fuzz
