#include "noise/half_correlation.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/gaussian.h"
#include "noise/fission.h"
#include "support/images.h"

namespace polyrecon {
namespace {

constexpr int side = 128;

/// Two halves of a picture with independent noise of the correlation. The deviation is 20 times as high on the right as
/// on the left.
HalfPair halves_with_noise(double correlation, std::uint64_t stream = 5) {
  const Image picture = test::image_of(side, side, 3, [](int x, int y, int c) { return 1 + x * y + c; });
  HalfPair pair;
  pair.variance = test::image_of(side, side, 3, [](int x, int, int) { return x < side / 2 ? 0.01 : 4; });
  for (std::size_t h = 0; h < 2; ++h)
    pair.color.at(h) = split_halves(picture, pair.variance, stream + h, correlation).at(h);
  return pair;
}

/// The products of 97,536 pairs of signs give a correlation to about 0.005.
TEST(CorrelationOfHalves, IsThatOfTheNoise) {
  for (const double correlation : {0.25, 0.39})
    EXPECT_NEAR(correlation_of_halves(halves_with_noise(correlation)), correlation, 0.03);
}

/// One pixel in 97 of a half is a firefly.
TEST(CorrelationOfHalves, IsNotDecidedByFireflies) {
  HalfPair pair = halves_with_noise(0.39);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < pair.variance.pixels(); i += 97) pair.color[0].plane(c)[i] += Real(1000);
  EXPECT_NEAR(correlation_of_halves(pair), 0.39, 0.03);
}

TEST(CorrelationOfHalves, IsNoneOfIndependentPixels) { EXPECT_EQ(correlation_of_halves(halves_with_noise(0)), 0); }

TEST(CorrelationOfHalves, IsNoneWithoutNoise) {
  HalfPair pair = halves_with_noise(0.39);
  pair.color[1] = pair.color[0];
  EXPECT_EQ(correlation_of_halves(pair), 0);
}

/// Pixels that are no samples of the picture repeat the one next to them.
TEST(CorrelationOfHalves, LeavesOutPixelsThatAreNoSamples) {
  HalfPair pair = halves_with_noise(0);
  pair.sampled = Image(side, side, 1, Real(1));
  for (int y = 0; y < side; ++y)
    for (int x = side / 4; x < side; ++x) {
      pair.sampled.at(x, y, 0) = 0;
      for (int c = 0; c < 3; ++c)
        for (Image& color : pair.color) color.at(x, y, c) = color.at(side / 4 - 1, y, c);
    }
  EXPECT_EQ(correlation_of_halves(pair), 0);
  pair.sampled = {};
  EXPECT_GT(correlation_of_halves(pair), 0);
}

/// A picture that keeps little of its noise, as a denoiser's.
Image blurred(const Image& image) { return gaussian_blur(image, 3); }

TEST(MadeOfHalves, FindsTheNoiseThatADenoiserKeeps) {
  const HalfPair pair = halves_with_noise(0);
  const Image a = blurred(pair.color[0]), b = blurred(pair.color[1]);
  EXPECT_TRUE(made_of_halves(pair, a, b));
  EXPECT_TRUE(made_of_halves(pair, pair.color[0], pair.color[1]));
}

TEST(MadeOfHalves, RefusesOthers) {
  const HalfPair pair = halves_with_noise(0), other = halves_with_noise(0, 20);
  const Image a = blurred(pair.color[0]), b = blurred(pair.color[1]);
  EXPECT_FALSE(made_of_halves(pair, b, a)) << "swapped";
  EXPECT_FALSE(made_of_halves(pair, a, a)) << "equal";
  EXPECT_FALSE(made_of_halves(pair, blurred(other.color[0]), blurred(other.color[1]))) << "of another render";
  const Image holes(side, side, 3, std::numeric_limits<Real>::quiet_NaN());
  EXPECT_FALSE(made_of_halves(pair, holes, holes)) << "not finite";
}

TEST(MadeOfHalves, IsNotToldWithoutNoise) {
  HalfPair pair = halves_with_noise(0);
  pair.color[1] = pair.color[0];
  EXPECT_TRUE(made_of_halves(pair, pair.color[0], pair.color[0]));
}

}  // namespace
}  // namespace polyrecon
