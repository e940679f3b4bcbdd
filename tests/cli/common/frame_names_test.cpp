#include "cli/common/frame_names.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

using nlohmann::json;

/// The examples that the drivers' tests read too.
const json& examples() {
  static const json read = json::parse(std::ifstream(POLYRECON_SOURCE_DIR "/tests/inputs/frame_names.json"));
  return read;
}

std::vector<json> examples(const char* list) {
  const json& found = examples().at(list);
  EXPECT_FALSE(found.empty()) << list;
  return {found.begin(), found.end()};
}

TEST(FrameNames, EveryPatternNamesItsFile) {
  for (const json& example : examples("names")) {
    const auto pattern = FramePattern::parse(example["pattern"]);
    ASSERT_TRUE(pattern) << example;
    EXPECT_EQ(pattern->path(example["frame"]), example["name"]) << example;
    EXPECT_EQ(pattern->frame_of(example["name"]), example["frame"].get<int>()) << example;
  }
}

TEST(FrameNames, OtherNamesAreNoPatterns) {
  for (const json& text : examples("no_patterns")) EXPECT_FALSE(FramePattern::parse(text)) << text;
}

TEST(FrameNames, OtherFilesAreNoFrames) {
  for (const json& example : examples("no_frames")) {
    const auto pattern = FramePattern::parse(example["pattern"]);
    ASSERT_TRUE(pattern) << example;
    EXPECT_FALSE(pattern->frame_of(example["name"])) << example;
  }
}

TEST(FrameNames, DigitsAfterThePlaceAreNoPartOfTheNumber) {
  EXPECT_EQ(FramePattern::parse("shot#5.exr")->frame_of("shot75.exr"), 7);
  EXPECT_EQ(FramePattern::parse("shot.####")->frame_of("shot.99999999999"), std::nullopt);
}

TEST(FrameNames, RangesAreRead) {
  for (const json& example : examples("ranges"))
    EXPECT_EQ(parse_frames(example["text"]), example["frames"].get<std::vector<int>>()) << example;
}

TEST(FrameNames, OtherRangesAreRefused) {
  for (const json& text : examples("refused_ranges")) try {
      parse_frames(text);
      ADD_FAILURE() << text << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::Usage) << text;
    }
}

TEST(FrameNames, FramesBecomeText) {
  for (const json& example : examples("texts")) EXPECT_EQ(frames_text(example["frames"]), example["text"]) << example;
}

TEST(FrameNames, FramesInAFolder) {
  const auto folder = std::filesystem::temp_directory_path() / ("polyrecon-names-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  for (const char* name : {"a.0010.exr", "a.0002.exr", "a.-003.exr", "a.12345.exr", "a.7.exr", "b.0001.exr", "c#.exr"})
    std::ofstream(folder / name).flush();
  const auto frames = [&](const char* name) {
    return FramePattern::parse((folder / name).string())->existing_frames();
  };
  EXPECT_EQ(frames("a.%04d.exr"), (std::vector<int>{-3, 2, 10, 12345}));
  EXPECT_EQ(frames("a.####.exr"), (std::vector<int>{2, 10, 12345}));
  EXPECT_FALSE(FramePattern::parse((folder / "c#.exr").string()));  // a file of this very name
  const auto code_of = [&](const std::string& text) {
    try {
      FramePattern::parse((folder / text).string())->existing_frames();
    } catch (const Error& error) {
      return error.code();
    }
    return ExitCode::Done;
  };
  std::filesystem::create_directory(folder / "####");  // a folder of this very name has no places
  std::ofstream(folder / "####" / "s.0005.exr").flush();
  EXPECT_EQ(frames("####/s.####.exr"), std::vector<int>{5});
  EXPECT_EQ(FramePattern::parse((folder / "####" / "s.####.exr").string())->path(5), folder / "####" / "s.0005.exr");
  std::filesystem::remove_all(folder / "####");
  EXPECT_EQ(code_of(std::string(300, '#')), ExitCode::Usage);  // longer than a name can be
  EXPECT_EQ(code_of("none.####.exr"), ExitCode::Missing);
  EXPECT_EQ(code_of("####/shot.####.exr"), ExitCode::Usage);
  std::filesystem::remove_all(folder);
}

TEST(FrameNames, TheLastNumberInANameIsTheFrame) {
  EXPECT_EQ(frame_in_name("v2/shot.0012.exr"), 12);
  EXPECT_EQ(frame_in_name("shot12_v3.exr"), 3);
  EXPECT_EQ(frame_in_name("v2/shot.exr"), std::nullopt);
}

}  // namespace
}  // namespace polyrecon
