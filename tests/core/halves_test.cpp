#include "core/halves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

TEST(VarianceOfMean, IsUnbiasedForHalvesOfUnequalNoise) {
  test::Random random(1);
  const double sigma_a = 0.5, sigma_b = 1.5, truth = sigma_a * sigma_a / 4 + sigma_b * sigma_b / 4;
  constexpr int draws = 20000;
  double sum = 0, squares = 0;
  for (int k = 0; k < draws; ++k) {
    const double v = variance_of_mean(3 + sigma_a * random.normal(), 3 + sigma_b * random.normal());
    sum += v;
    squares += v * v;
  }
  const double mean = sum / draws, error = std::sqrt((squares / draws - mean * mean) / draws);
  EXPECT_NEAR(mean, truth, 4 * error);
}

TEST(MeanOfHalves, TakesTheFirstChannels) {
  const auto value = [](int x, int y, int c) { return x + 10 * y + 100 * c; };
  const Image a = test::image_of(3, 2, 4, value), b = test::times(a, 3);
  EXPECT_TRUE(test::same_bits(mean_of_halves({a, b}, 4), test::times(a, 2)));
  EXPECT_TRUE(test::same_bits(mean_of_halves({a, b}, 3), crop(test::times(a, 2), a.bounds(), 0, 3)));
}

}  // namespace
}  // namespace polyrecon
