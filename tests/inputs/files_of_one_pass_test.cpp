// Renders that have a file for each pass, with the numbers of frames and versions in their names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/exr_fixture.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/write_result.h"

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
      {"Image0001", "Denoising Albedo0001", "Denoising Normal0001"},        // its default slot
      {"shot_RGBA.1001", "shot_albedo.1001", "shot_N.1001"},
      {"shot.C.1001", "shot.albedo.1001", "shot.N.1001"},
      {"shot.1001", "shot.albedo.1001", "shot.N.1001"},
      {"shot_beauty", "shot_beauty_albedo", "shot_beauty_normal"},
      {"shot_0001_beauty", "shot_0001_albedo", "shot_0001_normal"},
      {"shot.0001", "shot_albedo.0001", "shot.normal.0001"},
      {"shot", "shot_albedo", "shot-normal"},
      {"beauty_shot.0001", "albedo_shot.0001", "normal_shot.0001"},
      {"Beauty.Shot_010_v03", "Albedo.Shot_010_v03", "Normals.Shot_010_v03"},
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

/// A beauty with a depth of its own, or with a light next to it.
TEST(FilesOfOnePass, AreFoundForABeautyOfSeveralLayers) {
  for (const char* more : {"Z", "light"}) {
    const TemporaryFolder folder;
    TestPart part;
    part.channels = layer("", "RGB", 1);
    const std::string name = more;
    const auto added = name == "Z" ? layer("", "Z", 9) : layer(name, "RGB", 9);
    part.channels.insert(part.channels.end(), added.begin(), added.end());
    const std::string path = write_exr(folder / "shot_beauty.0001.exr", {part});
    write_pass(folder, "shot_albedo.0001", 2);
    write_pass(folder, "shot_Z.0001", 3);
    const Frame frame = read_frame(path).frame;
    EXPECT_EQ(upper_left(frame.beauty.mean), pattern(1)(0, 0)) << more;
    ASSERT_EQ(frame.features.size(), 2U) << more;
    EXPECT_EQ(upper_left(frame.features[0].pass.mean), pattern(2)(0, 0)) << more;
    const double of_three = (pattern(3)(0, 0) + pattern(4)(0, 0) + pattern(5)(0, 0)) / 3;  // the file's R G B
    EXPECT_EQ(frame.features[1].pass.mean.at(0, 0, 0), static_cast<Real>(name == "Z" ? pattern(9)(0, 0) : of_three))
        << more;
  }
}

TEST(FilesOfOnePass, VariancesAndDenoisedPicturesAreFound) {
  for (const char* variance : {"shot_beauty_variance.0001", "shot_variance.0001"}) {
    const TemporaryFolder folder;
    write_pass(folder, "shot_beauty.0001", 1);
    write_pass(folder, variance, 2);
    write_pass(folder, "shot_beauty_denoised.0001", 3);
    const Frame frame = read_frame(folder / "shot_beauty.0001.exr").frame;
    ASSERT_FALSE(frame.beauty.variance.empty()) << variance;
    EXPECT_EQ(upper_left(frame.beauty.variance), pattern(2)(0, 0)) << variance;
    ASSERT_FALSE(frame.prior.mean.empty());
    EXPECT_EQ(upper_left(frame.prior.mean), pattern(3)(0, 0));
  }
}

TEST(FilesOfOnePass, AResultOfThisProgramIsNoPrior) {
  const TemporaryFolder folder;
  write_pass(folder, "shot_beauty", 1);
  const std::string path = folder / "shot_beauty.exr";
  const ReadResult read = read_frame(path);
  WriteOptions options;
  options.provenance.settings = "--quality draft";
  write_result(read.source, {{read.frame.beauty.name, read.frame.beauty.mean, false, read.frame.data_window}},
               folder / "shot_denoised.exr", options);
  const ReadResult again = read_frame(path);
  EXPECT_TRUE(again.frame.prior.mean.empty());
  EXPECT_TRUE(again.notes.empty());
}

TEST(FilesOfOnePass, ShortWordsThatDoNotStandApartAreNoPass) {
  const TemporaryFolder folder;
  write_pass(folder, "shot_beauty", 1);
  for (const char* name : {"shot_z2", "shot_n", "shot_P", "shotN"}) write_pass(folder, name, 2);
  EXPECT_TRUE(read_frame(folder / "shot_beauty.exr").frame.features.empty());
}

}  // namespace
}  // namespace polyrecon
