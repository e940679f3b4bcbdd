// Renders that have a folder for each pass.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "io/exr_fixture.h"
#include "io/inspect.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using testing::layer;
using testing::pattern;
using testing::stored_floats;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

/// Paths of the files of one frame, extensions left out.
struct Paths {
  std::string beauty, albedo, normal;
};

std::string write_pass(const TemporaryFolder& folder, const std::string& name, int seed, const Rect& window) {
  TestPart part;
  part.window = part.display = window;
  part.channels = layer("", "RGB", seed);
  const std::string path = folder / (name + ".exr");
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  return write_exr(path, {part});
}

std::string write_pass(const TemporaryFolder& folder, const std::string& name, int seed) {
  return write_pass(folder, name, seed, {0, 0, 8, 6});
}

/// Returns the file with the picture.
std::string write_render(const TemporaryFolder& folder, const Paths& paths) {
  write_pass(folder, paths.albedo, 2);
  write_pass(folder, paths.normal, 3);
  return write_pass(folder, paths.beauty, 1);
}

double upper_left(const Image& image) { return static_cast<double>(image.at(0, 0, 0)); }

TEST(FilesInFolders, AreFoundByTheNamesOfTheFolders) {
  for (const Paths& paths : std::vector<Paths>{
           {"beauty/shot.0001", "albedo/shot.0001", "normal/shot.0001"},
           {"shot/beauty/a.0001", "shot/albedo/a.0001", "shot/normal/a.0001"},
           {"RGBA/shot.0001", "AOV_albedo/shot.0001", "AOV_N/shot.0001"},
           {"AOV_RGBA/shot", "AOV_albedo/shot", "AOV_N/shot"},
           {"beauty/0001", "albedo/0001", "normal/0001"},
           {"shot_beauty_v02/shot.0001", "shot_albedo_v02/shot.0001", "shot_normal_v02/shot.0001"},
           {"beauty/shot_beauty.0001", "albedo/shot_albedo.0001", "normal/shot_normal.0001"},
           {"beauty/shot.0001", "albedo/shot_albedo.0001", "N/shot.normal.0001"},
           {"Image/Image0001", "Denoising Albedo/Denoising Albedo0001", "Denoising Normal/Denoising Normal0001"},
           {"beauty/v03/shot.0001", "albedo/v03/shot.0001", "normal/v03/shot.0001"},
           {"beauty/shot_beauty.0001", "aovs/shot_albedo.0001", "aovs/shot_normal.0001"},
           {"shot/shot.0001", "shot/albedo/shot.0001", "shot/normal/shot.0001"},
           {"shot/shot.0001", "shot/aovs/shot_albedo.0001", "shot/aovs/shot_normal.0001"},
       }) {
    const TemporaryFolder folder;
    const ReadResult read = read_frame(write_render(folder, paths));
    EXPECT_EQ(upper_left(read.frame.beauty.mean), pattern(1)(0, 0)) << paths.beauty;
    ASSERT_EQ(read.frame.features.size(), 2U) << paths.beauty;
    EXPECT_EQ(upper_left(read.frame.features[0].pass.mean), pattern(3)(0, 0)) << paths.beauty;
    EXPECT_EQ(upper_left(read.frame.features[1].pass.mean), pattern(2)(0, 0)) << paths.beauty;
    const std::filesystem::path input = std::filesystem::path(paths.beauty).parent_path();
    EXPECT_THAT(read.notes,
                Contains(HasSubstr(std::filesystem::path(paths.albedo + ".exr").lexically_relative(input).string())));
  }
}

TEST(FilesInFolders, ThoseOfOtherShotsFramesAndCamerasAreNot) {
  for (const Paths& paths : std::vector<Paths>{
           {"a/beauty/shot.0001", "b/albedo/shot.0001", "b/normal/shot.0001"},
           {"beauty/shot.0001", "albedo/shot.0002", "normal/shot.0002"},
           {"beauty/a.0001", "albedo/b.0001", "normal/b.0001"},
           {"beauty/left/shot.0001", "albedo/right/shot.0001", "normal/shot.0001"},
           {"beauty/shot.0001", "albedo/right/shot.0001", "right_normal/shot.0001"},
           {"a_beauty/shot.0001", "b_albedo/shot.0001", "normal/shot.0001"},
           {"beauty_v1/shot.0001", "albedo_v2/shot.0001", "normal/shot.0001"},
           {"shadow/shot.0001", "albedo/shot.0001", "normal/shot.0001"},  // a shot of this name, as there is no beauty
       }) {
    const TemporaryFolder folder;
    const ReadResult read = read_frame(write_render(folder, paths));
    EXPECT_EQ(upper_left(read.frame.beauty.mean), pattern(1)(0, 0)) << paths.beauty;
    EXPECT_TRUE(read.frame.features.empty()) << paths.beauty;
    EXPECT_TRUE(read.notes.empty()) << paths.beauty;
  }
}

TEST(FilesInFolders, ThoseNextToTheInputComeFirst) {
  const TemporaryFolder folder;
  write_pass(folder, "beauty/shot_albedo.0001", 9);
  const Frame frame = read_frame(write_render(folder, {"beauty/shot_beauty.0001", "albedo/shot_albedo.0001",
                                                       "normal/shot_beauty.0001"}))
                          .frame;
  ASSERT_EQ(frame.features.size(), 2U);
  EXPECT_EQ(upper_left(frame.features[1].pass.mean), pattern(9)(0, 0));
}

TEST(FilesInFolders, APassOfAnotherSizeIsLeftOutWithANote) {
  const TemporaryFolder folder;
  for (const char* name : {"albedo/shot", "shot_normal"}) write_pass(folder, name, 2, {0, 0, 16, 12});
  for (const std::string& path : {write_pass(folder, "beauty/shot", 1), write_pass(folder, "shot_beauty", 1)}) {
    const ReadResult read = read_frame(path);
    EXPECT_TRUE(read.frame.features.empty());
    EXPECT_THAT(read.notes,
                Contains(AllOf(HasSubstr("16 x 12 pixels, that of the beauty 8 x 6"), HasSubstr("--map ROLE="))));
  }
  ReadOptions options;
  options.map = {{Role::Albedo, Companion::Mean, folder / "albedo/shot.exr", {}}};
  EXPECT_EQ(read_frame(folder / "beauty/shot.exr", options).frame.features.size(), 1U);
}

TEST(FilesInFolders, InspectListsThem) {
  const TemporaryFolder folder;
  const Inspection found =
      inspect(write_render(folder, {"beauty/shot.0001", "albedo/shot.0001", "normal/shot.0001"}), {});
  EXPECT_EQ(found.source.files.size(), 3U);
  EXPECT_THAT(found.notes, Contains(HasSubstr("../albedo/shot.0001.exr")));
}

TEST(FilesInFolders, AreMergedWithTheirRenders) {
  const TemporaryFolder folder;
  std::vector<std::string> renders;
  for (const char* render : {"a", "b"}) {
    const std::string path = std::string(render) + "/";
    renders.push_back(write_render(folder, {path + "beauty/shot", path + "albedo/shot", path + "normal/shot"}));
  }
  merge(renders, folder / "out.exr");
  EXPECT_EQ(stored_floats(folder / "out.exr", 0, "albedo.R").front(), static_cast<float>(pattern(2)(0, 0)));
}

TEST(FilesInFolders, TheFileOfAPassNamesTheFileOfTheBeauty) {
  const TemporaryFolder folder;
  write_render(folder, {"beauty/shot.0001", "albedo/shot.0001", "normal/shot.0001"});
  try {
    read_frame(folder / "albedo/shot.0001.exr");
    FAIL() << "an albedo was taken for the beauty";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::Missing);
    EXPECT_THAT(error.what(), HasSubstr("beauty/shot.0001.exr; denoise that file"));
  }
}

}  // namespace
}  // namespace polyrecon
