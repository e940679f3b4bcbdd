// Renders with a file for each pass, as LuxCore writes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "io/exr_fixture.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::stored_floats;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

/// LuxCore writes three channels of every pass.
std::string pass(const std::string& path, double value) {
  TestPart part;
  part.channels = testing::flat_layer("", "RGB", value);
  return write_exr(path, {part});
}

/// Returns the file with the picture.
std::string film(const std::string& prefix, double picture, double samples) {
  pass(prefix + "ALBEDO.exr", picture / 10);
  pass(prefix + "DEPTH.exr", std::numeric_limits<double>::infinity());
  pass(prefix + "SAMPLECOUNT.exr", samples);
  pass(prefix + "ALPHA.exr", 0.5);
  pass(prefix + "DIRECT_DIFFUSE.exr", picture / 4);
  pass(prefix + "POSITION.exr", picture);
  pass(prefix + "RGB.exr", 99);  // the picture in another form
  return pass(prefix + "RGB_IMAGEPIPELINE.exr", picture);
}

TEST(FilesOfPasses, AreReadWithThePicture) {
  const TemporaryFolder folder;
  const Frame frame = read_frame(film(folder / "a_", 3, 8)).frame;
  EXPECT_EQ(frame.beauty.mean.at(0, 0, 0), 3);
  EXPECT_EQ(frame.sample_count.at(0, 0, 0), 8);
  EXPECT_EQ(frame.alpha.at(0, 0, 0), Real(0.5));
  ASSERT_EQ(frame.features.size(), 2U);
  EXPECT_EQ(frame.features[1].pass.mean.at(0, 0, 0), Real(1e10));
}

TEST(FilesOfPasses, AreMergedByTheirSampleCounts) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  const MergeResult merged = merge({film(folder / "a_", 1, 10), film(folder / "b_", 4, 20)}, out);
  EXPECT_THAT(stored_floats(out, 0, "RGB_IMAGEPIPELINE.R"), Each(3.0F));
  EXPECT_THAT(stored_floats(out, 0, "ALBEDO.G"), Each(0.3F));
  EXPECT_THAT(stored_floats(out, 0, "Sample Count.X"), Each(30.0F));
  EXPECT_THAT(stored_floats(out, 0, "ALPHA.R"), Each(0.5F));
  EXPECT_THAT(stored_floats(out, 0, "DIRECT_DIFFUSE.B"), Each(0.75F));
  EXPECT_THAT(stored_floats(out, 0, "POSITION.R"), Each(1.0F));  // that of the first render: a mean is nowhere
  EXPECT_THROW(stored_floats(out, 0, "RGB.R"), std::runtime_error);
  EXPECT_THAT(merged.notes, Contains(HasSubstr("RGB is left out: it holds the picture in another form")));
  const Frame frame = read_frame(out).frame;
  EXPECT_EQ(frame.beauty.mean.at(0, 0, 0), 3);
  EXPECT_FALSE(frame.beauty.variance.empty());
  EXPECT_EQ(frame.features.size(), 2U);
  EXPECT_EQ(merged.samples, 30);
}

TEST(FilesOfPasses, APassThatARenderLacksIsLeftOutWithANote) {
  const TemporaryFolder folder;
  const std::string a = film(folder / "a_", 1, 10), b = film(folder / "b_", 4, 20), out = folder / "out.exr";
  std::filesystem::remove(folder / "b_ALBEDO.exr");
  for (const auto& paths : {std::vector{a, b}, std::vector{b, a}}) {
    const MergeResult merged = merge(paths, out);
    EXPECT_THAT(stored_floats(out, 0, "RGB_IMAGEPIPELINE.R"), Each(3.0F));
    EXPECT_THROW(stored_floats(out, 0, "ALBEDO.R"), std::runtime_error);
    EXPECT_THAT(merged.notes, ElementsAre(HasSubstr("RGB is left out: it holds the picture in another form"),
                                          HasSubstr("ALBEDO is left out: not every render has a file with it")));
  }
}

TEST(FilesOfPasses, ARenderAloneIsMergedAsItIs) {
  const TemporaryFolder folder;
  const std::string a = film(folder / "a_", 1, 10), out = folder / "out.exr";
  const MergeResult merged = merge({a, pass(folder / "other.exr", 3)}, out);
  EXPECT_THAT(stored_floats(out, 0, "R"), Each(2.0F));
  EXPECT_EQ(merged.notes.size(), 8U);  // the picture in another form, six passes; sample counts are unknown
}

}  // namespace
}  // namespace polyrecon
