#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "fuzz/read_untrusted.h"
#include "io/exr_fixture.h"

namespace polyrecon::fuzz {
namespace {

/// The corpus holds seeds of the fuzzer and files that once failed.
TEST(FuzzCorpus, EveryFileIsReadOrRefused) {
  const testing::TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(POLYRECON_SOURCE_DIR "/tests/fuzz/corpus"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_GT(files.size(), 30u);
  for (const auto& file : files) EXPECT_NO_THROW(read_untrusted(file.string(), folder / "")) << file;
}

}  // namespace
}  // namespace polyrecon::fuzz
