#include "noise/fission.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

TEST(SplitHalves, AverageToTheMean) {
  const Image mean = test::image_of(40, 30, 3, [](int x, int y, int c) { return 0.3 * x + y + c; });
  const auto halves = split_halves(mean, Image(40, 30, 3, Real(4)), 0);
  EXPECT_LT(test::max_difference(test::mean_of(halves[0], halves[1]), mean), 1e-6 * test::max_magnitude(mean));
}

/// x = mean + n with n of variance v, halves x + sqrt(v) xi and x - sqrt(v) xi: over the noise n and xi each half has
/// variance 2 v and the two are uncorrelated. 40000 samples; standard errors of a variance s and a covariance: s
/// sqrt(2/N), s / sqrt(N).
TEST(SplitHalves, HaveTwiceTheVarianceAndNoCovariance) {
  const int size = 200;
  const double v = 0.25, n = size * size;
  test::Random random(11);
  const Image noisy = test::image_of(size, size, 1, [&](int, int, int) { return 3 + std::sqrt(v) * random.normal(); });
  for (const std::uint64_t stream : {0u, 1u, 7u}) {
    const auto halves = split_halves(noisy, Image(size, size, 1, Real(v)), stream);
    double aa = 0, bb = 0, ab = 0, a = 0;
    for (std::size_t i = 0; i < noisy.pixels(); ++i) {
      const double p = static_cast<double>(halves[0].plane(0)[i]) - 3,
                   q = static_cast<double>(halves[1].plane(0)[i]) - 3;
      a += p / n;
      aa += p * p / n;
      bb += q * q / n;
      ab += p * q / n;
    }
    EXPECT_LT(std::abs(a), 4 * std::sqrt(2 * v / n));
    EXPECT_LT(std::abs(aa - 2 * v), 4 * 2 * v * std::sqrt(2 / n));
    EXPECT_LT(std::abs(bb - 2 * v), 4 * 2 * v * std::sqrt(2 / n));
    EXPECT_LT(std::abs(ab), 4 * 2 * v / std::sqrt(n));
  }
}

TEST(SplitHalves, DependOnStreamPositionAndChannelOnly) {
  const Image mean(20, 20, 2), variance(20, 20, 2, Real(1));
  const auto once = split_halves(mean, variance, 5), again = split_halves(mean, variance, 5),
             other = split_halves(mean, variance, 6);
  EXPECT_TRUE(test::same_bits(once[0], again[0]));
  EXPECT_FALSE(test::same_bits(once[0], other[0]));
  EXPECT_NE(once[0].at(3, 4, 0), once[0].at(3, 4, 1));
  EXPECT_NE(once[0].at(3, 4, 0), once[0].at(4, 3, 0));
}

TEST(SplitHalves, WithoutVarianceBothAreTheImage) {
  const Image mean = test::image_of(5, 4, 3, [](int x, int y, int) { return x * y; });
  for (const Image& half : split_halves(mean, Image(5, 4, 3), 0)) EXPECT_TRUE(test::same_bits(half, mean));
}

/// What one half gets the other loses, so its correlations are those of the numbers: rho next to each other, rho^2
/// diagonally. Of 128 x 128 of them a correlation is known to 1 / 128.
TEST(SplitHalves, NoiseOfCorrelatedPixelsGetsTheirCorrelation) {
  constexpr int side = 128;
  const Image mean(side, side, 1), variance(side, side, 1, Real(4));
  for (const double rho : {0.0, 0.25, 0.39}) {
    const Image half = split_halves(mean, variance, 7, rho)[0];
    const auto product = [&](int dx, int dy) {
      double sum = 0;
      for (int y = 0; y + dy < side; ++y)
        for (int x = 0; x + dx < side; ++x)
          sum += static_cast<double>(half.at(x, y, 0)) * static_cast<double>(half.at(x + dx, y + dy, 0));
      return sum / ((side - dx) * (side - dy));
    };
    EXPECT_NEAR(product(0, 0), 4, 0.25) << rho;
    EXPECT_NEAR(product(1, 0) / 4, rho, 0.04) << rho;
    EXPECT_NEAR(product(0, 1) / 4, rho, 0.04) << rho;
    EXPECT_NEAR(product(1, 1) / 4, rho * rho, 0.04) << rho;
    EXPECT_NEAR(product(3, 0) / 4, 0, 0.04) << rho;
  }
}

}  // namespace
}  // namespace polyrecon
