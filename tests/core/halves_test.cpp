#include "core/halves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

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

/// Noise variance of a half, averaged, over that of the mean, of halves with na and nb samples.
double known_half_noise(double na, double nb) { return ((na + nb) / na + (na + nb) / nb) / 2; }

TEST(HalfNoise, IsTheMeanOfBothHalvesWhateverTheirCounts) {
  for (const auto& [na, nb] : {std::pair(8., 8.), std::pair(6., 2.), std::pair(1., 9.)}) {
    test::Random random(3);
    const auto half = [&](double n) {
      return test::image_of(20, 10, 3, [&](int, int, int c) { return c + random.normal() / std::sqrt(n); });
    };
    Image a = half(na), b = half(nb);
    const double weight_a = na / (na + nb), weight_b = nb / (na + nb);
    const Image mean = test::image_of(20, 10, 3, [&](int x, int y, int c) {
      return weight_a * static_cast<double>(a.at(x, y, c)) + weight_b * static_cast<double>(b.at(x, y, c));
    });
    a.at(3, 4, 1) = std::numeric_limits<Real>::infinity();
    EXPECT_NEAR(half_noise(mean, a, b), known_half_noise(na, nb), 1e-4);
  }
}

TEST(HalfNoise, IsTwoWhereTheHalvesTellNothing) {
  const auto flat = [](double value) { return test::image_of(4, 4, 3, [=](int, int, int) { return value; }); };
  EXPECT_EQ(half_noise(flat(1), flat(1), flat(1)), 2);
  EXPECT_EQ(half_noise(flat(1), flat(3), flat(2)), 2);  // not their mean
}

}  // namespace
}  // namespace polyrecon
