#include "core/halves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
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

/// Halves of `na` and `nb` samples of a picture with an edge, and their mean.
struct NoisyHalves {
  Image a, b, mean;
};

NoisyHalves noisy_halves(double na, double nb, double noise, std::uint64_t seed, double spikes = 0.01) {
  test::Random random(seed);
  const auto half = [&](double n) {
    return test::image_of(50, 37, 3, [&](int x, int, int c) {
      const double spike = random.uniform() < spikes ? 50 * random.uniform() : 0;
      return (x < 20 ? 0.1 : 2 + c) * (1 + noise * random.normal() / std::sqrt(n)) + noise * spike / n;
    });
  };
  NoisyHalves out{half(na), half(nb), {}};
  out.mean = test::image_of(50, 37, 3, [&](int x, int y, int c) {
    return (na * static_cast<double>(out.a.at(x, y, c)) + nb * static_cast<double>(out.b.at(x, y, c))) / (na + nb);
  });
  return out;
}

TEST(Contradict, HalvesOfTheMeanNeverDo) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    for (const auto& [na, nb] : {std::pair(8., 8.), std::pair(1., 15.), std::pair(30., 2.)})
      for (const double noise : {0., 0.01, 0.3, 3.}) {
        const NoisyHalves h = noisy_halves(na, nb, noise, seed);
        EXPECT_FALSE(contradict(h.mean, h.a, h.b)) << seed << " " << na << " " << nb << " " << noise;
      }
}

TEST(Contradict, HalvesOfAnotherRenderOfTheSceneDoNot) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    // Without spikes: one that only the other render has is no noise of these halves.
    const NoisyHalves h = noisy_halves(8, 8, 0.3, 2 * seed, 0), other = noisy_halves(8, 8, 0.3, 2 * seed + 1, 0);
    const Image smooth = test::mean_of(other.mean, h.mean);
    EXPECT_FALSE(contradict(smooth, h.a, h.b)) << seed;
  }
}

TEST(Contradict, HalvesOfAnotherEnergyOrPlaceDo) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const NoisyHalves h = noisy_halves(8, 8, 0.3, seed);
    for (const double factor : {0., 0.5, 0.8, 1.25, 3., 1e20, -1., nan})
      EXPECT_TRUE(contradict(h.mean, test::times(h.a, factor), test::times(h.b, factor))) << factor;
    EXPECT_TRUE(contradict(h.mean, h.a, test::times(h.b, nan)));
    EXPECT_TRUE(contradict(h.mean, h.a, test::times(h.b, 1e3)));
    Image spiked = h.a;  // a value that the mean has not seen
    spiked.at(5, 5, 1) = 1e10;
    EXPECT_TRUE(contradict(h.mean, spiked, h.b));
    const auto moved = [&](const Image& half, int by) {
      return test::image_of(50, 37, 3, [&](int x, int y, int c) { return half.at((x + by) % 50, y, c); });
    };
    EXPECT_TRUE(contradict(h.mean, moved(h.a, 10), moved(h.b, 10)));
    Image a = h.a, b = h.b;  // a bucket that failed in both
    for (int c = 0; c < 3; ++c)
      for (int y = 8; y < 16; ++y)
        for (int x = 24; x < 32; ++x) a.at(x, y, c) = b.at(x, y, c) = 0;
    EXPECT_TRUE(contradict(h.mean, a, b));
  }
}

TEST(Contradict, RoundingToHalfFloatsDoesNot) {
  const auto rounded = [](const Image& image) {
    return test::image_of(image.width(), image.height(), image.channels(), [&](int x, int y, int c) {
      int exponent = 0;
      const double scale = std::max(std::frexp(static_cast<double>(image.at(x, y, c)), &exponent), 0.);
      const double step = std::ldexp(1., std::max(exponent - 11, -24));
      return scale == 0 ? 0 : std::round(static_cast<double>(image.at(x, y, c)) / step) * step;
    });
  };
  for (const double radiance : {1., 1e-4, 1e-7}) {
    const NoisyHalves h = noisy_halves(8, 8, 1e-3, 5);
    const auto scaled = [&](const Image& image) { return rounded(test::times(image, radiance)); };
    EXPECT_FALSE(contradict(scaled(h.mean), scaled(h.a), scaled(h.b))) << radiance;
  }
}

TEST(Contradict, NoPictureIsTooDark) {
  for (const double radiance : {1e-8, 1e-20, 1e-30}) {
    const NoisyHalves h = noisy_halves(8, 8, 0.3, 5);
    const auto scaled = [&](const Image& image) { return test::times(image, radiance); };
    EXPECT_FALSE(contradict(scaled(h.mean), scaled(h.a), scaled(h.b))) << radiance;
    EXPECT_TRUE(contradict(scaled(h.mean), test::times(h.a, 0), scaled(h.b))) << radiance;
  }
}

}  // namespace
}  // namespace polyrecon
