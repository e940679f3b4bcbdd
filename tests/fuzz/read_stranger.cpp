#include "fuzz/read_stranger.h"

#include <fstream>
#include <functional>

#include "io/inspect.h"
#include "polyrecon/error.h"
#include "polyrecon/merge.h"
#include "polyrecon/write_result.h"

namespace polyrecon::fuzz {
namespace {

constexpr std::size_t kMemory = std::size_t{512} << 20;

void answer(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    if (error.code() == ExitCode::Internal) throw;
  }
}

}  // namespace

void read_stranger(const std::string& path, const std::string& folder) {
  ReadOptions options;
  options.limits.max_bytes = kMemory;
  answer([&] { inspect(path, options); });
  answer([&] {
    const ReadResult in = read_frame(path, options);
    write_result(in.source, {{in.frame.beauty.name, in.frame.beauty.mean, false}}, folder + "/result.exr", {});
  });
  answer([&] {
    const std::string copy = folder + "/copy.exr";
    // Not copy_file, which gives up when the alarm of libFuzzer's clock interrupts it.
    std::ofstream(copy, std::ios::binary) << std::ifstream(path, std::ios::binary).rdbuf();
    MergeOptions merging;
    merging.limits = options.limits;
    merge({path, copy}, folder + "/merged.exr", merging);
  });
}

}  // namespace polyrecon::fuzz
