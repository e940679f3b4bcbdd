// Lamps brighter than half floats reach: renderers store +Inf.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/exr_fixture.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/reconstruct.h"
#include "support/images.h"

namespace polyrecon {
namespace {

using testing::constant;
using ::testing::Each;
using ::testing::ElementsAre;
using testing::error_of;
using testing::flat_layer;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::join;
using testing::layer;
using testing::stored_floats;
using testing::TemporaryFolder;
using testing::TestChannel;
using testing::TestPart;
using testing::write_exr;

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr int width = 48, height = 40;

bool in_lamp(int x, int y) { return std::hypot(x - 24, y - 20) < 11.5; }  // wider than what a repair fills

/// A lamp of +Inf before a noisy wall of about 0.3.
TestPart lamp(Imf::PixelType type, int seed, double brightness = inf) {
  const Rect picture{0, 0, width, height};
  TestPart part = testing::part_over(picture, picture, layer("", "RGB", 0, type));
  for (TestChannel& channel : part.channels) {
    const int own_seed = 1000 * channel.name[0] + seed;
    channel.samples = [=](int x, int y) {
      return in_lamp(x, y) ? brightness : 0.25 + 0.1 * testing::grain(x, y, own_seed);
    };
  }
  return part;
}

/// The lamp's wall with a variance that is +Inf in the first `columns` columns.
ReadResult wall_with_variance(const TemporaryFolder& folder, int columns, Imf::PixelType type) {
  TestPart part = lamp(Imf::FLOAT, 1, 0.5);
  for (const char letter : {'R', 'G', 'B'})
    part.channels.push_back(
        {std::string("RGBA_variance.") + letter, type, [=](int x, int) { return x < columns ? inf : 1e-3; }});
  return read_frame(write_exr(folder / "wall.exr", {part}));
}

TEST(HalfOverflow, AVarianceThatHalvesCannotHoldIsLeftOut) {
  const TemporaryFolder folder;
  const ReadResult half = wall_with_variance(folder, 1, Imf::HALF);
  EXPECT_TRUE(half.frame.beauty.variance.empty());
  EXPECT_THAT(half.notes, ElementsAre(HasSubstr("is not used: 120 of its half-float samples are +Inf")));
  EXPECT_FALSE(wall_with_variance(folder, 0, Imf::HALF).frame.beauty.variance.empty());
  const ReadResult floats = wall_with_variance(folder, 1, Imf::FLOAT);
  EXPECT_FALSE(floats.frame.beauty.variance.empty());
  EXPECT_THAT(floats.notes, ElementsAre(HasSubstr("120 samples are not finite")));
}

TEST(HalfOverflow, RadianceThatAHalfCannotHoldIsTheLargestHalf) {
  const TemporaryFolder folder;
  const ReadResult read = read_frame(write_exr(folder / "lamp.exr", {lamp(Imf::HALF, 1)}));
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (in_lamp(x, y))
          EXPECT_EQ(read.frame.beauty.mean.at(x, y, c), 65504);
        else
          EXPECT_LT(read.frame.beauty.mean.at(x, y, c), 1);
      }
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("RGBA: 1263 half-float samples of +Inf count as 65504")));
}

/// The noisy wall, with +Inf where it is so wanted.
template <typename IsInfinite>
TestPart wall(const IsInfinite& is_infinite) {
  TestPart part = lamp(Imf::HALF, 1, 0.3);
  for (TestChannel& channel : part.channels)
    channel.samples = [=, stored = channel.samples](int x, int y) { return is_infinite(x, y) ? inf : stored(x, y); };
  return part;
}

TEST(HalfOverflow, LonePixelsAndPairsAreFilledFromTheirSurroundings) {
  const TemporaryFolder folder;
  const auto fireflies = [](int x, int y) {
    return (x == 5 && y == 7) || (x + y == 60 && x > 39 && x < 42) || x + y == 0;
  };
  ReadResult read = read_frame(write_exr(folder / "fireflies.exr", {wall(fireflies)}));
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("RGBA: 12 half-float samples of +Inf stand alone")));
  const Result result = reconstruct(read.frame, params_for(Quality::Draft), silent_progress());
  EXPECT_EQ(result.report.repaired_pixels, 4U);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        EXPECT_GT(result.beauty.at(x, y, c), 0.24) << x << " " << y;
        EXPECT_LT(result.beauty.at(x, y, c), 0.36) << x << " " << y;
      }
}

TEST(HalfOverflow, ALineIsALamp) {
  const TemporaryFolder folder;
  const ReadResult read =
      read_frame(write_exr(folder / "line.exr", {wall([](int x, int y) { return y == 3 && x > 9 && x < 13; })}));
  for (const int x : {10, 11, 12}) EXPECT_EQ(read.frame.beauty.mean.at(x, 3, 0), 65504);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("RGBA: 9 half-float samples of +Inf count as 65504")));
}

TEST(HalfOverflow, OneChannelAlone) {
  const TemporaryFolder folder;
  TestPart part = lamp(Imf::HALF, 1, 60000);
  part.channels[1].samples = constant(inf);
  const Image mean = read_frame(write_exr(folder / "lamp.exr", {part})).frame.beauty.mean;
  EXPECT_EQ(mean.at(24, 20, 0), 60000);  // the nearest half of 60000
  EXPECT_EQ(mean.at(24, 20, 1), 65504);
}

TEST(HalfOverflow, OtherInfinitiesStayAsTheyAre) {
  const TemporaryFolder folder;
  const auto flat = [](const char* name, const char* letters, Imf::PixelType type, double value) {
    auto channels = layer(name, letters, 0, type);
    for (TestChannel& channel : channels) channel.samples = constant(value);
    return channels;
  };
  TestPart part;
  part.channels = join({flat("V.Combined", "RGB", Imf::FLOAT, inf), flat("V.Denoising Albedo", "RGB", Imf::HALF, inf),
                        flat("V.Emit", "RGB", Imf::HALF, -inf)});
  ReadOptions options;
  options.aovs = {"Emit"};
  const ReadResult read = read_frame(write_exr(folder / "a.exr", {part}), options);
  EXPECT_EQ(read.frame.beauty.mean.at(0, 0, 0), inf);
  EXPECT_EQ(read.frame.features.front().pass.mean.at(0, 0, 0), inf);
  EXPECT_EQ(read.frame.aovs.front().mean.at(0, 0, 0), -inf);
  EXPECT_THAT(read.notes, IsEmpty());
}

Image denoised(ReadResult read) {
  const Result result = reconstruct(read.frame, params_for(Quality::Draft), silent_progress());
  EXPECT_EQ(result.report.repaired_pixels, 0U);
  return result.beauty;
}

/// The same picture in a float file, with the largest half in place of +Inf.
TEST(HalfOverflow, ALampIsDenoisedAsIfItWereTheLargestHalf) {
  const TemporaryFolder folder;
  TestPart floats = lamp(Imf::FLOAT, 1, 65504);
  for (TestChannel& channel : floats.channels)
    channel.samples = [stored = channel.samples](int x, int y) {
      return static_cast<float>(half(static_cast<float>(stored(x, y))));
    };
  const Image image = denoised(read_frame(write_exr(folder / "half.exr", {lamp(Imf::HALF, 1)})));
  EXPECT_TRUE(test::same_bits(image, denoised(read_frame(write_exr(folder / "float.exr", {floats})))));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (std::hypot(x - 24, y - 20) < 9) {
        EXPECT_NEAR(image.at(x, y, 0), 65504, 0.01 * 65504) << x << " " << y;
      }
}

TEST(HalfOverflow, MergedRendersHoldTheLargestHalf) {
  const TemporaryFolder folder;
  const std::string out = folder / "merged.exr";
  const MergeResult merged = merge(
      {write_exr(folder / "a.exr", {lamp(Imf::HALF, 1)}), write_exr(folder / "b.exr", {lamp(Imf::HALF, 2)})}, out);
  const auto mean = stored_floats(out, 0, "R"), variance = stored_floats(out, 0, "RGBA Variance.R");
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y * width + x);
      if (!in_lamp(x, y)) continue;
      EXPECT_EQ(mean[i], 65504);
      EXPECT_EQ(variance[i], 0);
    }
  EXPECT_THAT(merged.notes, ::testing::Contains(HasSubstr("RGBA: 2526 half-float samples of +Inf count as 65504")));
}

/// As in a single render: a lamp of three pixels is one, also where the lines that are merged at once end inside it.
TEST(HalfOverflow, MergeLeavesFirefliesOut) {
  const TemporaryFolder folder;
  const int wide = 3000, high = 40;
  const auto render = [&](const char* name, int seed, const auto& is_infinite) {
    const Rect picture{0, 0, wide, high};
    TestPart part = testing::part_over(picture, picture, layer("", "RGB", 0, Imf::HALF));
    for (TestChannel& channel : part.channels)
      channel.samples = [=](int x, int y) {
        return is_infinite(x, y) ? inf : 0.25 + 0.1 * testing::grain(x, y, 1000 * channel.name[0] + seed);
      };
    return write_exr(folder / name, {part});
  };
  const auto in_lamp_of_three = [](int x, int y) { return x == 30 && y >= 30 && y < 33; };
  const auto firefly = [](int x, int y) { return (x == 5 && y == 31) || (x == 9 && (y == 31 || y == 32)); };
  const std::string out = folder / "merged.exr";
  const MergeResult merged =
      merge({render("a.exr", 1, in_lamp_of_three),
             render("b.exr", 2, [&](int x, int y) { return in_lamp_of_three(x, y) || firefly(x, y); })},
            out);
  const auto mean = stored_floats(out, 0, "R");
  for (int y = 0; y < high; ++y)
    for (const int x : {4, 5, 9, 30}) {
      const float value = mean[static_cast<std::size_t>(y * wide + x)];
      if (in_lamp_of_three(x, y))
        EXPECT_EQ(value, 65504) << y;
      else
        EXPECT_LT(value, 0.36F) << x << " " << y;
    }
  EXPECT_THAT(merged.notes, ::testing::IsSupersetOf({HasSubstr("RGBA: 9 half-float samples of +Inf stand alone"),
                                                     HasSubstr("RGBA: 18 half-float samples of +Inf count as 65504")}));
}

}  // namespace
}  // namespace polyrecon
