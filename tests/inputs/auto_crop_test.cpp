// Parts that a renderer cut to boxes of their own (auto-crop), one box for each pass. Outside its box a pass is 0.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr_fixture.h"
#include "io/files/file.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

using namespace testing;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Rect display{0, 0, 12, 9};

/// A part of one layer whose values are 0 outside `box`, with that box or the whole picture as its data window.
TestPart boxed(const std::string& name, const std::string& letters, int seed, const Rect& box, bool cut) {
  TestPart part = part_over(cut ? box : display, display, layer(name, letters, seed));
  part.name = name;
  for (TestChannel& channel : part.channels)
    channel.samples = [box, inside = channel.samples](int x, int y) { return box.contains(x, y) ? inside(x, y) : 0; };
  return part;
}

std::vector<TestPart> render(bool cut) {
  return {boxed("beauty", "RGBA", 0, {0, 2, 12, 9}, cut), boxed("albedo", "RGB", 10, {3, 0, 12, 5}, cut),
          boxed("N", "XYZ", 20, {0, 3, 7, 9}, cut), boxed("Z", "Z", 30, {5, 4, 8, 6}, cut),
          boxed("diffuse", "RGB", 40, {2, 1, 9, 8}, cut)};
}

/// The part r of an image as bytes.
std::vector<Real> samples(const Image& image, const Rect& r) {
  std::vector<Real> all;
  for (int c = 0; c < image.channels(); ++c)
    for (int y = r.y0; y < r.y1; ++y) all.insert(all.end(), image.row(c, y) + r.x0, image.row(c, y) + r.x1);
  return all;
}

TEST(AutoCrop, PassesAreZeroOutsideTheirBoxes) {
  const TemporaryFolder folder;
  const ReadResult whole = read_frame(write_exr(folder / "whole.exr", render(false)));
  const ReadResult cut = read_frame(write_exr(folder / "cut.exr", render(true)));
  EXPECT_THAT(cut.notes, IsEmpty());
  EXPECT_EQ(cut.frame.data_window, (Rect{0, 2, 12, 9}));
  const Rect box = cut.frame.data_window, all = cut.frame.beauty.mean.bounds();
  EXPECT_EQ(samples(cut.frame.beauty.mean, all), samples(whole.frame.beauty.mean, box));
  EXPECT_EQ(samples(cut.frame.alpha, all), samples(whole.frame.alpha, box));
  ASSERT_THAT(cut.frame.features, SizeIs(3));
  for (std::size_t f = 0; f < 3; ++f)
    EXPECT_EQ(samples(cut.frame.features[f].pass.mean, all), samples(whole.frame.features[f].pass.mean, box)) << f;
}

TEST(AutoCrop, LayersWithinTheBoxOfTheBeautyAreReadWithIt) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts = render(true);
  parts[4] = boxed("diffuse", "RGB", 40, {2, 3, 9, 8}, true);
  ReadOptions options;
  options.aovs = {"diffuse"};
  const ReadResult read = read_frame(write_exr(folder / "cut.exr", parts), options);
  EXPECT_EQ(read.frame.data_window, (Rect{0, 2, 12, 9}));
  ASSERT_THAT(read.frame.aovs, SizeIs(1));
  EXPECT_EQ(static_cast<double>(read.frame.aovs[0].mean.at(2, 1, 0)), pattern(40)(2, 3));
  EXPECT_EQ(read.frame.aovs[0].mean.at(2, 0, 0), 0);
  EXPECT_THAT(read.outside_beauty, IsEmpty());
}

/// Beyond its box the beauty is 0, so a layer that is not is no part of it; and the beauty may be a crop.
TEST(AutoCrop, ALayerThatReachesBeyondTheBeautyIsReadByItself) {
  const TemporaryFolder folder;
  const std::string path = write_exr(folder / "cut.exr", render(true));
  ReadOptions options;
  options.aovs = {"diffuse"};
  const ReadResult read = read_frame(path, options);
  EXPECT_EQ(read.frame.data_window, (Rect{0, 2, 12, 9}));
  EXPECT_THAT(read.frame.aovs, IsEmpty());
  EXPECT_THAT(read.outside_beauty, ::testing::ElementsAre("diffuse"));
  EXPECT_THAT(read.notes, ::testing::ElementsAre(HasSubstr("diffuse gets windows of its own")));
  options.aovs.clear();
  options.own_windows = "diffuse";
  const Frame frame = read_frame(path, options).frame;
  EXPECT_EQ(frame.data_window, (Rect{2, 1, 9, 8}));
  EXPECT_EQ(static_cast<double>(frame.beauty.mean.at(0, 0, 0)), pattern(40)(2, 1));
  EXPECT_EQ(static_cast<double>(frame.features[1].pass.mean.at(1, 0, 0)), pattern(10)(3, 1));
}

TEST(AutoCrop, ResultsAreWrittenIntoTheBoxes) {
  const TemporaryFolder folder;
  const ReadResult read = read_frame(write_exr(folder / "cut.exr", render(true)));
  const Rect window{0, 1, 12, 9};  // of all that is written
  const Image beauty(window.width(), window.height(), 3, 7), diffuse(window.width(), window.height(), 3, 5);
  Image numbered(window.width(), window.height(), 1);
  for (std::size_t i = 0; i < numbered.pixels(); ++i) numbered.plane(0)[i] = static_cast<Real>(i);
  write_result(
      read.source,
      {{"beauty", beauty, false, window}, {"diffuse", diffuse, false, window}, {"beauty", numbered, true, window}},
      folder / "out.exr");
  const FileInfo out = describe_file(folder / "out.exr");
  for (const std::size_t part : {0, 1, 2, 3, 4})
    EXPECT_EQ(out.parts[part].data_window, read.source.files[0].parts[part].data_window) << part;
  EXPECT_EQ(samples(read_channels(out, 0, {"beauty.R", "beauty.G", "beauty.B"}), {0, 0, 12, 7}),
            std::vector<Real>(3 * 12 * 7, 7));
  EXPECT_EQ(samples(read_channels(out, 4, {"diffuse.R"}), {0, 0, 7, 7}), std::vector<Real>(7 * 7, 5));
  const Image alpha = read_channels(out, 0, {"beauty.A"});
  EXPECT_EQ(alpha.at(0, 0, 0), 12);  // the frame begins one row above the beauty's box
  EXPECT_EQ(alpha.at(11, 6, 0), 95);
}

/// A picture layer with a larger box than the frame's, such as that of the renderer's denoiser.
TEST(AutoCrop, PixelsThatTheFrameDoesNotCoverKeepTheirValues) {
  const TemporaryFolder folder;
  const ReadResult read = read_frame(write_exr(folder / "cut.exr", render(true)));
  const Image small(2, 2, 3, 9);
  write_result(read.source, {{"beauty", small, false, {4, 3, 6, 5}}}, folder / "out.exr");
  const Image out = read_channels(describe_file(folder / "out.exr"), 0, {"beauty.R"});
  for (int y = 2; y < 9; ++y)
    for (int x = 0; x < 12; ++x)
      EXPECT_EQ(static_cast<double>(out.at(x, y - 2, 0)), (Rect{4, 3, 6, 5}.contains(x, y)) ? 9 : pattern(0)(x, y));
}

TEST(AutoCrop, APassOfAnotherPictureSizeIsNotUsed) {
  const TemporaryFolder folder;
  const std::string in = write_exr(folder / "in.exr", {boxed("beauty", "RGB", 0, display, true)});
  TestPart half;  // half the resolution
  half.window = half.display = {0, 0, 6, 5};
  half.channels = layer("", "RGB", 10);
  write_exr(folder / "half.exr", {half});
  TestPart outside = boxed("albedo", "RGB", 10, {20, 20, 24, 24}, true);
  write_exr(folder / "outside.exr", {outside});
  for (const char* name : {"half.exr", "outside.exr"}) {
    ReadOptions options;
    options.map.push_back(parse_mapping("albedo=" + (folder / name)));
    const ReadResult read = read_frame(in, options);
    EXPECT_THAT(read.frame.features, IsEmpty()) << name;
    EXPECT_THAT(read.notes, Contains(HasSubstr("is not used"))) << name;
  }
}

/// A feature that one render lacks at the rim is that of the others there; radiance is averaged with the zeros.
TEST(AutoCrop, MergeTakesFeaturesFromTheRendersThatHaveThem) {
  const TemporaryFolder folder;
  const auto render_with = [&](const char* name, const Rect& box) {
    TestPart beauty = part_over(display, display, layer("", "RGB", 1));
    beauty.name = "beauty";
    TestPart albedo = part_over(box, display, layer("albedo", "RGB", 10)),
             light = part_over(box, display, layer("light", "RGB", 20));
    albedo.name = "albedo";
    light.name = "light";
    return write_exr(folder / name, {beauty, albedo, light});
  };
  const Rect large{1, 0, 12, 9}, small{3, 2, 10, 9};
  const std::string out = folder / "merged.exr";
  merge({render_with("a.exr", large), render_with("b.exr", small), render_with("c.exr", large)}, out);
  const auto albedo = stored_floats(out, 0, "albedo.R"), light = stored_floats(out, 0, "light.R");
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 12; ++x) {
      const auto i = static_cast<std::size_t>(y * 12 + x);
      const double whole = large.contains(x, y) ? 1 : 0, shown = small.contains(x, y) ? 1 : whole * 2 / 3;
      EXPECT_FLOAT_EQ(albedo[i], static_cast<float>(whole * pattern(10)(x, y))) << x << " " << y;
      EXPECT_FLOAT_EQ(light[i], static_cast<float>(shown * pattern(20)(x, y))) << x << " " << y;
    }
}

}  // namespace
}  // namespace polyrecon
