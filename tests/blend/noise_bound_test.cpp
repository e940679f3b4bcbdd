#include "blend/noise_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

using test::image_of;

/// The standard deviations that a colour may differ by, radiance, if all colours have the same noise.
double deviation_at(const Image& bound, int x, int y) { return std::sqrt(static_cast<double>(bound.at(x, y, 0)) / 3); }

TEST(NoiseBound, IsFiveStandardDeviationsWhereNoiseIsAlikeAllOver) {
  const Image bound = noise_bound(Image(20, 15, 3, Real(0.04)));
  for (const auto& [x, y] : {std::pair{10, 7}, std::pair{0, 0}, std::pair{19, 14}})
    EXPECT_NEAR(deviation_at(bound, x, y), 1, 1e-5);
  EXPECT_EQ(test::max_magnitude(noise_bound(Image(20, 15, 3))), 0);
  EXPECT_NEAR(deviation_at(noise_bound(Image(1, 1, 3, Real(0.04))), 0, 0), 1, 1e-6);
}

TEST(NoiseBound, IsTheSumOfTheSquaresOfTheColours) {
  const Image bound = noise_bound(image_of(20, 15, 3, [](int, int, int c) { return 0.01 * (c + 1); }));
  EXPECT_EQ(bound.channels(), 1);
  EXPECT_NEAR(static_cast<double>(bound.at(10, 7, 0)), 25 * (0.01 + 0.02 + 0.03), 1e-5);
}

/// Noise ends at an edge: pixels of the side with little noise have its bound, the others the bound of their own noise.
TEST(NoiseBound, NextToNoiseItIsThatOfTheLessNoisySide) {
  const Image bound = noise_bound(image_of(40, 20, 3, [](int x, int, int) { return x < 20 ? 1e-6 : 1; }));
  EXPECT_NEAR(deviation_at(bound, 19, 10), 0.005, 1e-5);
  EXPECT_NEAR(deviation_at(bound, 20, 10), 5, 1e-5);
}

/// A pixel without a spike among pixels of which some have one may be as wrong as these.
TEST(NoiseBound, AmongSpikesIsTheirs) {
  test::Random random(3);
  const Image bound = noise_bound(image_of(60, 60, 3, [&](int, int, int) { return random.uniform() < 0.2 ? 1 : 0; }));
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) EXPECT_GT(deviation_at(bound, x, y), 0.1);
}

TEST(NoiseBound, TurnsWithTheImage) {
  test::Random random(4);
  const Image variance = image_of(23, 17, 3, [&](int, int, int) { return random.uniform(); });
  const auto transposed = [](const Image& image) {
    return image_of(image.height(), image.width(), image.channels(),
                    [&](int x, int y, int c) { return image.at(y, x, c); });
  };
  EXPECT_LT(test::max_difference(noise_bound(transposed(variance)), transposed(noise_bound(variance))), 1e-5);
}

}  // namespace
}  // namespace polyrecon
