// Renders that have a file for each pass, with the numbers of frames and versions in their names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/exr_fixture.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

using ::testing::HasSubstr;
using testing::layer;
using testing::pattern;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

/// Names of the files of one frame, extensions left out.
struct Names {
  std::string beauty, albedo, normal;
};

void write_pass(const TemporaryFolder& folder, const std::string& name, int seed) {
  TestPart part;
  part.channels = layer("", "RGB", seed);
  write_exr(folder / (name + ".exr"), {part});
}

double upper_left(const Image& image) { return static_cast<double>(image.at(0, 0, 0)); }

const std::vector<Names>& all_names() {
  static const std::vector<Names> names{
      {"shot_beauty.0001", "shot_albedo.0001", "shot_normal.0001"},
      {"shot_beauty_0001", "shot_albedo_0001", "shot_normal_0001"},
      {"shot.beauty.-0005", "shot.albedo.-0005", "shot.normal.-0005"},
      {"shot_v2_beauty_v02.0001", "shot_v2_albedo_v02.0001", "shot_v2_normal_v02.0001"},
      {"Noisy Image0001", "Denoising Albedo0001", "Denoising Normal0001"},  // Blender's compositor
      {"shot_0001_beauty", "shot_0001_albedo", "shot_0001_normal"},
      {"shot.0001", "shot_albedo.0001", "shot.normal.0001"},
      {"shot", "shot_albedo", "shot-normal"},
  };
  return names;
}

TEST(FilesOfOnePass, AreFoundByThePassInTheirNames) {
  for (const Names& names : all_names()) {
    const TemporaryFolder folder;
    write_pass(folder, names.beauty, 1);
    write_pass(folder, names.albedo, 2);
    write_pass(folder, names.normal, 3);
    const ReadResult read = read_frame(folder / (names.beauty + ".exr"));
    EXPECT_EQ(upper_left(read.frame.beauty.mean), pattern(1)(0, 0)) << names.beauty;
    ASSERT_EQ(read.frame.features.size(), 2U) << names.beauty;
    EXPECT_EQ(read.frame.features[0].role, Role::Normal);
    EXPECT_EQ(upper_left(read.frame.features[0].pass.mean), pattern(3)(0, 0)) << names.beauty;
    EXPECT_EQ(read.frame.features[1].role, Role::Albedo);
    EXPECT_EQ(upper_left(read.frame.features[1].pass.mean), pattern(2)(0, 0)) << names.beauty;
    ASSERT_EQ(read.notes.size(), 1U);
    EXPECT_THAT(read.notes[0], HasSubstr(names.albedo + ".exr"));
  }
}

TEST(FilesOfOnePass, OtherFramesAndResultsAreNotFound) {
  const TemporaryFolder folder;
  write_pass(folder, "shot_beauty.0001", 1);
  for (const char* name : {"shot_albedo.0002", "shot_albedo", "shot_albedo.10001", "other_albedo.0001"})
    write_pass(folder, name, 2);
  EXPECT_TRUE(read_frame(folder / "shot_beauty.0001.exr").frame.features.empty());
  // A file whose name has no pass takes features alone: a denoised picture next to it is a result.
  write_pass(folder, "shot.0003", 1);
  for (const char* name : {"shot_denoised.0003", "shot_beauty.0003", "shotalbedo.0003"}) write_pass(folder, name, 2);
  const ReadResult read = read_frame(folder / "shot.0003.exr");
  EXPECT_TRUE(read.frame.features.empty());
  EXPECT_TRUE(read.frame.prior.mean.empty());
  EXPECT_TRUE(read.notes.empty());
}

}  // namespace
}  // namespace polyrecon
