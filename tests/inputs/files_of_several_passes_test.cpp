// Renders with a file for the picture and another one for several passes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "io/exr_fixture.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::layer;
using testing::pattern;
using testing::stored_floats;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

constexpr int beauty_seed = 1, albedo_seed = 10, normal_seed = 20, depth_seed = 30;

void append(std::vector<testing::TestChannel>& to, const std::vector<testing::TestChannel>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

std::string write_file(const TemporaryFolder& folder, const std::string& name,
                       const std::vector<testing::TestChannel>& channels) {
  const std::string path = folder / (name + ".exr");
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  TestPart part;
  part.channels = channels;
  return write_exr(path, {part});
}

std::vector<testing::TestChannel> passes() {
  auto channels = layer("albedo", "RGB", albedo_seed);
  append(channels, layer("N", "XYZ", normal_seed));
  append(channels, layer("", "Z", depth_seed));
  return channels;
}

double upper_left(const Image& image) { return static_cast<double>(image.at(0, 0, 0)); }

void expect_passes(const Frame& frame, const std::string& what) {
  EXPECT_EQ(upper_left(frame.beauty.mean), pattern(beauty_seed)(0, 0)) << what;
  ASSERT_EQ(frame.features.size(), 3U) << what;
  EXPECT_EQ(upper_left(frame.features[0].pass.mean), pattern(normal_seed)(0, 0)) << what;
  EXPECT_EQ(upper_left(frame.features[1].pass.mean), pattern(albedo_seed)(0, 0)) << what;
  EXPECT_EQ(upper_left(frame.features[2].pass.mean), pattern(depth_seed)(0, 0)) << what;
}

/// Paths of the picture and of the passes, extensions left out.
struct Paths {
  std::string picture, passes;
};

TEST(FileOfSeveralPasses, IsFoundByItsName) {
  for (const Paths& paths : std::vector<Paths>{
           {"shot_beauty", "shot_aovs"},
           {"shot_beauty.0001", "shot_aov.0001"},
           {"s.beauty.1001", "s.data.1001"},
           {"shot.0001", "shot_aovs.0001"},
           {"shot.0001", "shot.passes.0001"},
           {"shot_RGBA_v02.0001", "shot_utility_v02.0001"},
           {"shot_beauty", "shot_lookdev"},  // any word, as the file has no picture
           {"beauty.0001", "aovs.0001"},
           {"shot.0001", "AOVs/shot.0001"},
           {"beauty/shot.0001", "aovs/shot.0001"},
           {"shot_beauty", "shot_albedo"},  // named after one of its passes
       }) {
    const TemporaryFolder folder;
    const std::string path = write_file(folder, paths.picture, layer("", "RGB", beauty_seed));
    write_file(folder, paths.passes, passes());
    const ReadResult read = read_frame(path);
    expect_passes(read.frame, paths.passes);
    EXPECT_THAT(read.notes, Contains(HasSubstr(std::filesystem::path(paths.passes).filename().string() + ".exr")));
  }
}

TEST(FileOfSeveralPasses, GivesWhatThePictureAndFilesOfOnePassLack) {
  const TemporaryFolder folder;
  auto picture = layer("", "RGB", beauty_seed);
  append(picture, layer("", "Z", depth_seed));
  const std::string path = write_file(folder, "shot_beauty", picture);
  write_file(folder, "shot_albedo", layer("", "RGB", albedo_seed));
  auto others = layer("albedo", "RGB", 40);
  append(others, layer("N", "XYZ", normal_seed));
  append(others, layer("", "Z", 50));
  write_file(folder, "shot_aovs", others);
  const ReadResult read = read_frame(path);
  expect_passes(read.frame, "mixed");
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("shot_albedo.exr, shot_aovs.exr (N)")));
}

TEST(FileOfSeveralPasses, MayHoldThePictureTooWhereItsNameSaysWhatItIs) {
  auto channels = passes();
  append(channels, layer("", "RGB", 60));
  const TemporaryFolder folder;
  const std::string path = write_file(folder, "shot_beauty", layer("", "RGB", beauty_seed));
  write_file(folder, "shot_lookdev", channels);  // a picture of its own
  EXPECT_TRUE(read_frame(path).frame.features.empty());
  write_file(folder, "shot_aovs", channels);
  expect_passes(read_frame(path).frame, "with a picture");
}

TEST(FileOfSeveralPasses, OfAnotherShotOrFrameIsNotTaken) {
  for (const Paths& paths : std::vector<Paths>{{"a_beauty.0001", "b_aovs.0001"},
                                               {"a_beauty.0001", "a_aovs.0002"},
                                               {"beauty.0001", "lookdev.0001"},
                                               {"a.0001", "a_cam_aovs.0001"},
                                               {"a.0001", "b/aovs/a.0001"}}) {
    const TemporaryFolder folder;
    const std::string path = write_file(folder, paths.picture, layer("", "RGB", beauty_seed));
    write_file(folder, paths.passes, passes());
    const ReadResult read = read_frame(path);
    EXPECT_TRUE(read.frame.features.empty()) << paths.passes;
    EXPECT_THAT(read.notes, IsEmpty()) << paths.passes;
    EXPECT_EQ(read.frame.beauty.name, "RGBA");
  }
}

TEST(FileOfSeveralPasses, IsMergedWithItsPicture) {
  const TemporaryFolder folder;
  const auto render = [&](const std::string& shot, double value) {
    auto channels = testing::flat_layer("albedo", "RGB", value / 10);
    append(channels, testing::flat_layer("N", "XYZ", value));
    write_file(folder, shot + "_aovs", channels);
    return write_file(folder, shot + "_beauty", testing::flat_layer("", "RGB", value));
  };
  const std::string out = folder / "out.exr";
  merge({render("a", 1), render("b", 3)}, out);
  EXPECT_THAT(stored_floats(out, 0, "albedo.G"), ::testing::Each(0.2F));
  EXPECT_EQ(read_frame(out).frame.features.size(), 2U);
}

}  // namespace
}  // namespace polyrecon
