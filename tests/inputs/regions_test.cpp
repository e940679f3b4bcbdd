// Regions of one frame in files of their own, and renders of one frame whose boxes differ (auto-crop).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr_fixture.h"
#include "io/files/file.h"
#include "polyrecon/merge.h"

namespace polyrecon {
namespace {

using namespace testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const Rect frame{0, 0, 12, 9};

TestPart region(const Rect& window, std::vector<TestChannel> channels) {
  return part_over(window, frame, std::move(channels));
}

std::vector<TestChannel> passes() {
  return join({layer("V.Combined", "RGBA", 0), layer("V.Denoising Albedo", "RGB", 10, Imf::HALF),
               layer("V.IndexOB", "X", 20, Imf::UINT)});
}

std::vector<std::string> channel_names(const std::string& path) {
  std::vector<std::string> names;
  const FileInfo file = describe_file(path);
  for (const ChannelInfo& channel : file.parts[0].channels) names.push_back(channel.name);
  return names;
}

/// One channel over the whole result.
Image read(const std::string& path, const std::string& channel) {
  return read_channels(describe_file(path), 0, {channel});
}

TEST(Regions, DisjointRegionsOfOneRenderAreJoinedAsTheyAre) {
  const TemporaryFolder folder;
  const std::vector<Rect> windows{{6, 0, 12, 4}, {0, 0, 6, 4}, {0, 4, 5, 9}, {5, 4, 12, 9}};
  std::vector<TestPart> parts;
  for (const Rect& window : windows) parts.push_back(region(window, passes()));
  const MergeResult result = merge(write_all(folder, parts), folder / "out.exr");
  EXPECT_TRUE(result.joined);
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("4 regions are joined")));
  EXPECT_EQ(describe_file(folder / "out.exr").parts[0].data_window, frame);
  for (const TestChannel& channel : passes()) {
    const Image image = read(folder / "out.exr", channel.name);
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 12; ++x)
        ASSERT_EQ(static_cast<double>(image.at(x, y, 0)), channel.samples(x, y)) << channel.name << x << " " << y;
  }
  for (const std::string& name : channel_names(folder / "out.exr"))
    EXPECT_THAT(name, Not(HasSubstr("Variance"))) << "the difference of two regions is no noise";
}

TEST(Regions, NothingStandsBetweenRegions) {
  const TemporaryFolder folder;
  merge(write_all(folder, {region({1, 1, 4, 4}, passes()), region({6, 5, 9, 8}, passes())}), folder / "out.exr");
  EXPECT_EQ(describe_file(folder / "out.exr").parts[0].data_window, (Rect{1, 1, 9, 8}));
  for (const char* name : {"V.Combined.R", "V.Combined.A", "V.Denoising Albedo.R", "V.IndexOB.X"}) {
    const Image image = read(folder / "out.exr", name);
    EXPECT_EQ(image.at(3, 3, 0), 0) << name;
    EXPECT_EQ(image.at(7, 0, 0), 0) << name;
  }
}

/// Regions that were merged before they are joined keep what is known of their noise.
TEST(Regions, VarianceAndHalvesOfTheRegionsAreKept) {
  const TemporaryFolder folder;
  const auto with_noise = [](const Rect& window, double value) {
    return region(window,
                  join({flat_layer("V.Combined", "RGB", value), flat_layer("V.Combined Variance", "RGB", value + 1),
                        flat_layer("V.Combined A", "RGB", value + 2), flat_layer("V.Combined B", "RGB", value + 3)}));
  };
  merge(write_all(folder, {with_noise({0, 0, 6, 9}, 1), with_noise({6, 0, 12, 9}, 11)}), folder / "out.exr");
  int step = 0;
  for (const char* name : {"V.Combined.G", "V.Combined Variance.G", "V.Combined A.G", "V.Combined B.G"}) {
    const Image image = read(folder / "out.exr", name);
    EXPECT_EQ(image.at(5, 8, 0), Real(1 + step)) << name;
    EXPECT_EQ(image.at(6, 0, 0), Real(11 + step)) << name;
    ++step;
  }
}

/// Two renders of each of two regions, whose files come region by region: each region has its own halves.
TEST(Regions, RendersOfEachRegionAreMergedThere) {
  const TemporaryFolder folder;
  const auto flat = [](const Rect& window, double value) {
    return region(window, flat_layer("V.Combined", "RGBA", value));
  };
  const Rect left{0, 0, 6, 9}, right{6, 0, 12, 9};
  const std::vector<std::string> paths =
      write_all(folder, {flat(left, 1), flat(right, 10), flat(left, 3), flat(right, 20)});
  const MergeResult result = merge(paths, folder / "out.exr");
  EXPECT_FALSE(result.joined);
  const auto at = [&](const std::string& layer, int x) { return read(folder / "out.exr", layer + ".R").at(x, 4, 0); };
  EXPECT_EQ(at("V.Combined", 5), 2);
  EXPECT_EQ(at("V.Combined", 6), 15);
  EXPECT_EQ(at("V.Combined Variance", 5), 1);   // (1 + 1) / (4 - 2)
  EXPECT_EQ(at("V.Combined Variance", 6), 25);  // (25 + 25) / (4 - 2)
  EXPECT_EQ(at("V.Combined A", 5), 1);
  EXPECT_EQ(at("V.Combined B", 5), 3);
  EXPECT_EQ(at("V.Combined A", 6), 10);
  EXPECT_EQ(at("V.Combined B", 6), 20);
}

/// Regions with a margin in common: there both have samples.
TEST(Regions, MarginsInCommonAreAveraged) {
  const TemporaryFolder folder;
  const auto flat = [](const Rect& window, double value) {
    return region(window, flat_layer("V.Combined", "RGB", value));
  };
  merge(write_all(folder, {flat({0, 0, 7, 9}, 2), flat({5, 0, 12, 9}, 6)}), folder / "out.exr");
  const Image image = read(folder / "out.exr", "V.Combined.R");
  EXPECT_EQ(image.at(4, 0, 0), 2);
  EXPECT_EQ(image.at(5, 0, 0), 4);
  EXPECT_EQ(image.at(7, 0, 0), 6);
}

/// What is cut from a picture that is black but for the inside and one pixel of its rim.
TestPart box_of_noise(const Rect& box, double value) {
  TestPart part =
      region(box, join({flat_layer("V.Combined", "RGB", value), flat_layer("V.Denoising Albedo", "RGB", 0.5)}));
  const Rect inside{2, 2, 10, 7};
  for (TestChannel& channel : part.channels)
    channel.samples = [=, stored = channel.samples](int x, int y) {
      return inside.contains(x, y) || y == 4 ? stored(x, y) : 0;
    };
  return part;
}

/// The boxes of noisy renders differ: outside its box a render saw black, which counts.
TEST(Regions, BoxesOfOnePictureAreMergedOverTheirUnion) {
  const TemporaryFolder folder;
  const MergeResult result =
      merge(write_all(folder, {box_of_noise({1, 1, 10, 8}, 2), box_of_noise({2, 1, 11, 8}, 4)}), folder / "out.exr");
  EXPECT_THAT(result.dropped, IsEmpty());
  EXPECT_EQ(describe_file(folder / "out.exr").parts[0].data_window, (Rect{1, 1, 11, 8}));
  const Image mean = read(folder / "out.exr", "V.Combined.R"),
              variance = read(folder / "out.exr", "V.Combined Variance.R"),
              albedo = read(folder / "out.exr", "V.Denoising Albedo.R");
  EXPECT_EQ(mean.at(0, 3, 0), 1);  // x = 1: 2 and 0
  EXPECT_EQ(mean.at(1, 3, 0), 3);
  EXPECT_EQ(mean.at(9, 3, 0), 2);  // x = 10: 0 and 4
  EXPECT_EQ(variance.at(0, 3, 0), 1);
  EXPECT_EQ(variance.at(9, 3, 0), 4);
  EXPECT_EQ(albedo.at(0, 3, 0), Real(0.25));
}

TestPart lit(const Rect& window, double value) { return region(window, flat_layer("V.Combined", "RGBA", value)); }

/// The picture goes on beyond the window of one render: no black is averaged.
TEST(Regions, WindowsOfAPictureThatGoesOnAreNoBoxes) {
  const TemporaryFolder folder;
  const auto paths = write_all(folder, {lit({0, 0, 12, 9}, 2), lit({0, 0, 12, 9}, 4), lit({1, 0, 12, 8}, 6)});
  const MergeResult result = merge(paths, folder / "out.exr");
  const Image mean = read(folder / "out.exr", "V.Combined.R"),
              variance = read(folder / "out.exr", "V.Combined Variance.R");
  EXPECT_EQ(mean.at(0, 4, 0), 3);
  EXPECT_EQ(mean.at(5, 8, 0), 3);
  EXPECT_EQ(mean.at(1, 7, 0), 4);
  EXPECT_EQ(variance.at(0, 4, 0), 1);
  EXPECT_EQ(variance.at(1, 7, 0), Real(4.0 / 3));  // (4 + 0 + 4) / (9 - 3)
  EXPECT_THAT(result.notes, ::testing::Contains(HasSubstr("1 of 3 renders show a part of the picture only")));
}

/// A region that was rendered again, in a window of its own or black outside, and the whole frame.
TEST(Regions, ARegionWithinAFrameIsMergedThereOnly) {
  const Rect inner{3, 2, 9, 7};
  for (const bool cropped : {true, false}) {
    const TemporaryFolder folder;
    TestPart again = lit(cropped ? inner : frame, 8);
    if (!cropped)
      for (TestChannel& channel : again.channels)
        channel.samples = [=](int x, int y) { return inner.contains(x, y) ? 8 : 0; };
    const MergeResult result = merge(write_all(folder, {lit(frame, 2), again}), folder / "out.exr");
    const Image mean = read(folder / "out.exr", "V.Combined.G"), alpha = read(folder / "out.exr", "V.Combined.A");
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 12; ++x) {
        ASSERT_EQ(mean.at(x, y, 0), inner.contains(x, y) ? 5 : 2) << x << " " << y;
        ASSERT_EQ(alpha.at(x, y, 0), inner.contains(x, y) ? 5 : 2) << x << " " << y;
      }
    EXPECT_TRUE(result.joined);
    EXPECT_THAT(result.notes, ::testing::Contains(HasSubstr("72 % of the picture has one render only")));
    for (const std::string& name : channel_names(folder / "out.exr")) EXPECT_THAT(name, Not(HasSubstr("Variance")));
  }
}

TEST(Regions, LargeMarginsInCommonAreAveraged) {
  const TemporaryFolder folder;
  merge(write_all(folder, {lit({0, 0, 9, 9}, 2), lit({3, 0, 12, 9}, 6)}), folder / "out.exr");
  const Image image = read(folder / "out.exr", "V.Combined.R");
  EXPECT_EQ(image.at(2, 0, 0), 2);
  EXPECT_EQ(image.at(3, 0, 0), 4);
  EXPECT_EQ(image.at(8, 8, 0), 4);
  EXPECT_EQ(image.at(9, 8, 0), 6);
}

/// A wide picture that is mostly black: what one render shows beyond the other's window is more than chance.
TEST(Regions, AWindowThatEndsBeforeSparseLightIsNoBox) {
  const TemporaryFolder folder;
  const Rect wide{0, 0, 200, 9};
  std::vector<TestPart> parts{lit(wide, 0), lit({0, 0, 200, 7}, 0)};
  for (TestPart& part : parts) {
    part.display = wide;
    for (TestChannel& channel : part.channels) channel.samples = [=](int x, int) { return x % 8 == 0 ? 4 : 0; };
  }
  merge(write_all(folder, parts), folder / "out.exr");
  const Image mean = read(folder / "out.exr", "V.Combined.R");
  EXPECT_EQ(mean.at(16, 6, 0), 4);
  EXPECT_EQ(mean.at(16, 7, 0), 4);
  EXPECT_EQ(mean.at(16, 8, 0), 4);
}

/// Regions whose files keep the window of the frame, black outside.
TEST(Regions, RegionsThatAreBlackOutsideAreJoined) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts;
  for (const Rect& window : std::vector<Rect>{{0, 0, 6, 9}, {6, 0, 12, 9}}) {
    parts.push_back(region(frame, passes()));
    for (TestChannel& channel : parts.back().channels)
      channel.samples = [=, stored = channel.samples](int x, int y) {
        return window.contains(x, y) ? stored(x, y) + 1 : 0;
      };
  }
  const MergeResult result = merge(write_all(folder, parts), folder / "out.exr");
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("2 regions are joined")));
  EXPECT_EQ(describe_file(folder / "out.exr").parts[0].data_window, frame);
  for (const TestChannel& channel : passes()) {
    const Image image = read(folder / "out.exr", channel.name);
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 12; ++x)
        ASSERT_EQ(static_cast<double>(image.at(x, y, 0)), channel.samples(x, y) + 1) << channel.name << x << " " << y;
  }
}

/// Two renders of a sparse picture, each black where the other has light: all black counts.
TEST(Regions, BlackByChanceCounts) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts;
  for (const int turn : {0, 1}) {
    parts.push_back(lit(frame, 0));
    for (TestChannel& channel : parts.back().channels)
      channel.samples = [=](int x, int y) { return (3 * x + 5 * y) % 8 == 4 * turn ? 4 : 0; };
  }
  merge(write_all(folder, parts), folder / "out.exr");
  const Image mean = read(folder / "out.exr", "V.Combined.R"),
              variance = read(folder / "out.exr", "V.Combined Variance.R");
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 12; ++x) {
      const bool is_lit = (3 * x + 5 * y) % 4 == 0;
      ASSERT_EQ(mean.at(x, y, 0), is_lit ? 2 : 0) << x << " " << y;
      ASSERT_EQ(variance.at(x, y, 0), is_lit ? 4 : 0) << x << " " << y;
    }
}

/// The variance of one region says nothing of the other.
TEST(Regions, VarianceThatOneRegionLacksIsLeftOut) {
  const TemporaryFolder folder;
  TestPart left = lit({0, 0, 6, 9}, 1), right = lit({6, 0, 12, 9}, 2);
  left.channels =
      join({left.channels, flat_layer("V.Combined Variance", "RGB", 3), flat_layer("V.Sample Count", "X", 4)});
  for (const auto& parts : {std::vector{left, right}, std::vector{right, left}}) {
    const MergeResult result = merge(write_all(folder, parts), folder / "out.exr");
    EXPECT_THAT(result.notes,
                ::testing::Contains(HasSubstr("V.Combined Variance is left out: not every render has it")));
    for (const std::string& name : channel_names(folder / "out.exr")) {
      EXPECT_THAT(name, Not(HasSubstr("Variance")));
      EXPECT_THAT(name, Not(HasSubstr("Sample Count")));
    }
    EXPECT_EQ(read(folder / "out.exr", "V.Combined.R").at(6, 4, 0), 2);
  }
}

/// Nothing is said of halves that are not written.
TEST(Regions, UnevenHalvesAreNotNotedWhereNoneAreWritten) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts{lit({0, 0, 6, 9}, 1), lit({6, 0, 12, 9}, 2)};
  for (TestPart& part : parts) part.channels = join({part.channels, flat_layer("V.Sample Count", "X", 16)});
  const auto paths = write_all(folder, parts);
  EXPECT_THAT(merge(paths, folder / "out.exr").notes, ElementsAre(HasSubstr("2 regions are joined")));
  MergeOptions options;
  options.half_b = {paths[1]};
  EXPECT_THAT(merge({paths[0]}, folder / "out.exr", options).notes,
              ::testing::Contains(HasSubstr("--half-b has no effect")));
}

/// Each pass is cut to its own box.
TEST(Regions, PassesWithBoxesOfTheirOwnAreMerged) {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& name, double value) {
    TestPart beauty = region({0, 0, 12, 9}, flat_layer("beauty", "RGB", value));
    TestPart albedo = region({3, 2, 12, 8}, flat_layer("albedo", "RGB", value));
    beauty.name = "beauty";
    albedo.name = "albedo";
    return write_exr(folder / name, {beauty, albedo});
  };
  const MergeResult result = merge({write("a.exr", 1), write("b.exr", 3)}, folder / "out.exr");
  EXPECT_THAT(result.merged, ElementsAre("beauty", "albedo"));
  const Image albedo = read(folder / "out.exr", "albedo.R");
  EXPECT_EQ(albedo.at(2, 2, 0), 0);
  EXPECT_EQ(albedo.at(3, 2, 0), 2);
  EXPECT_EQ(read(folder / "out.exr", "albedo Variance.R").at(2, 2, 0), 0);
}

/// A crop that has forgotten its place in the picture cannot be joined.
TEST(Regions, ARegionWithoutAPlaceIsRefused) {
  const TemporaryFolder folder;
  TestPart crop = region({0, 0, 6, 9}, passes());
  crop.display = crop.window;
  const auto paths = write_all(folder, {region({0, 0, 6, 9}, passes()), crop});
  const Error error = error_of([&] { merge(paths, folder / "out.exr"); });
  EXPECT_EQ(error.code(), ExitCode::BadInput);
  EXPECT_THAT(error.what(), HasSubstr("its place in the picture is unknown"));
}

TEST(Regions, RegionsFarApartAreRefusedBeforeAnyMemoryIsTaken) {
  const TemporaryFolder folder;
  const int far = 1 << 28;
  const auto paths = write_all(
      folder, {region({-far, -far, 4 - far, 4 - far}, passes()), region({far, far, far + 4, far + 4}, passes())});
  EXPECT_EQ(error_of([&] { merge(paths, folder / "out.exr"); }).code(), ExitCode::BadInput);
}

}  // namespace
}  // namespace polyrecon
