#include "maps/error_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "blend/select.h"
#include "core/gaussian.h"
#include "support/images.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

Candidate candidate_of(const Image& a, const Image& b, const Image& squared_bias) {
  return {{a, b}, squared_bias, Image(a.width(), a.height(), 3), Image(a.width(), a.height(), 1)};
}

/// The variance of the mean, from that of a half.
Image times_half(const Image& variance) { return test::times(variance, 0.5); }

Image textured(int width, int height) {
  return test::image_of(width, height, 3,
                        [](int x, int y, int c) { return 10 + std::sin(0.9 * x + c) + ((x + y) % 3); });
}

double mean_half(const Candidate& result, int x, int y, int c) {
  return 0.5 * (static_cast<double>(result.half[0].at(x, y, c)) + static_cast<double>(result.half[1].at(x, y, c)));
}

/// The error of each pixel is min(bias^2 + (f_A - f_B)^2 / 4, noise), relative, with the latter two averaged over 2
/// pixels.
TEST(ErrorMap, IsBiasOfTheWindowsAndVarianceOfTheHalvesBelowTheNoise) {
  const Image truth = textured(24, 20);
  const HalfPair pair = test::pair_of(truth, 0.6, 5);
  Image claims(24, 20, 3, Real(0.01));
  for (int c = 0; c < 3; ++c) claims.at(7, 9, c) = 50;  // a window contaminated by a firefly
  const Candidate result = candidate_of(gaussian_blur(pair.color[0], 1), gaussian_blur(pair.color[1], 1), claims);
  const ErrorMap map = make_error_map(pair, times_half(pair.variance), result);
  const auto energy = [&](int x, int y, int c) {
    const double f = mean_half(result, x, y, c);
    return f * f + 0.01;
  };
  const Image variance = gaussian_blur(test::image_of(24, 20, 3,
                                                      [&](int x, int y, int c) {
                                                        const double d =
                                                            static_cast<double>(result.half[0].at(x, y, c)) -
                                                            static_cast<double>(result.half[1].at(x, y, c));
                                                        return d * d / 4 / energy(x, y, c);
                                                      }),
                                       2);
  const Image noise = test::image_of(24, 20, 3, [&](int x, int y, int c) {
    return static_cast<double>(pair.variance.at(x, y, c)) / 2 / energy(x, y, c);
  });
  const Image bound = gaussian_blur(noise, 2);
  double sum = 0;
  int bounded = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) {
      double relative = 0, input = 0;
      for (int c = 0; c < 3; ++c) {
        const double bias = static_cast<double>(claims.at(x, y, c)) / energy(x, y, c);
        const double limit = bound.at(x, y, c), mse = bias + static_cast<double>(variance.at(x, y, c));
        bounded += mse > limit;
        EXPECT_NEAR(static_cast<double>(map.mse.at(x, y, c)), std::min(mse, limit) * energy(x, y, c), 1e-6);
        relative += std::min(mse, limit) / 3;
        input += static_cast<double>(noise.at(x, y, c)) / 3;
      }
      EXPECT_NEAR(static_cast<double>(map.relative_mse.at(x, y, 0)), relative, 1e-6 * relative);
      EXPECT_NEAR(static_cast<double>(map.relative_noise.at(x, y, 0)), input, 1e-6 * input);
      sum += relative;
    }
  EXPECT_EQ(bounded, 3);
  EXPECT_NEAR(map.mean_relative_mse, sum / (24 * 20), 1e-6 * map.mean_relative_mse);
}

/// The halves' difference is an unbiased measure of the mean's variance: over 100 draws of a smoother without bias the
/// map's mean is the true one within 4 standard errors.
TEST(ErrorMap, IsUnbiasedForASmootherOfAConstant) {
  const Image truth(24, 20, 3, Real(10));
  double sum = 0, square = 0;
  const int draws = 100;
  for (int draw = 0; draw < draws; ++draw) {
    const HalfPair pair = test::pair_of(truth, 0.6, 1000 + static_cast<std::uint64_t>(draw));
    const Candidate result =
        candidate_of(gaussian_blur(pair.color[0], 1), gaussian_blur(pair.color[1], 1), Image(24, 20, 3));
    double actual = 0;
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 24; ++x) {
          const double f = mean_half(result, x, y, c);
          actual += (f - 10) * (f - 10) / (f * f + 0.01) / (3.0 * static_cast<double>(truth.pixels()));
        }
    const double estimate = make_error_map(pair, times_half(pair.variance), result).mean_relative_mse;
    sum += estimate - actual;
    square += (estimate - actual) * (estimate - actual);
  }
  const double mean = sum / draws, standard_error = std::sqrt((square / draws - mean * mean) / draws);
  EXPECT_LT(std::abs(mean), 4 * standard_error);
}

TEST(ErrorMap, IsFiniteAndNotNegative) {
  const HalfPair pair = test::pair_of(Image(16, 16, 3), 0.1, 6);  // black: yhat about 0
  const Candidate result = candidate_of(pair.color[0], pair.color[1], pair.variance);
  const ErrorMap map = make_error_map(pair, times_half(pair.variance), result);
  for (const Image* image : {&map.mse, &map.relative_mse, &map.relative_variance, &map.relative_noise}) {
    EXPECT_TRUE(test::all_finite(*image));
    for (int c = 0; c < image->channels(); ++c)
      for (std::size_t i = 0; i < image->pixels(); ++i) EXPECT_GE(image->plane(c)[i], Real(0));
  }
  for (std::size_t i = 0; i < map.relative_mse.pixels(); ++i)
    EXPECT_LE(map.relative_variance.plane(0)[i], map.relative_mse.plane(0)[i]);
}

TEST(ErrorMap, WithoutAnyVarianceIsZero) {
  const Image truth = textured(16, 16);
  const HalfPair pair = test::pair_of(truth, 0, 7);
  const ErrorMap map = make_error_map(pair, pair.variance, candidate_of(truth, truth, Image(16, 16, 3)));
  EXPECT_EQ(test::max_magnitude(map.mse), 0);
  EXPECT_EQ(map.mean_relative_mse, 0);
}

TEST(LowerError, TakesHalfOfWhatTheMixGains) {
  ErrorMap error;
  error.mse = Image(8, 8, 3, Real(0.09));
  error.relative_mse = Image(8, 8, 1, Real(0.09 / 1.01));
  error.relative_variance = Image(8, 8, 1, Real(0.08));
  const Image ours(8, 8, 3, Real(1)), prior(8, 8, 3, Real(1.2)), share(8, 8, 1, Real(0.5));
  lower_error(ours, prior, share, {}, error);
  EXPECT_NEAR(error.prior_share.at(4, 4, 0), 1 - 0.5, 1e-6);
  const double after = 0.09 - 0.5 * 0.1 * 0.1, denominator = 1.1 * 1.1 + 0.01;
  EXPECT_NEAR(error.mse.at(4, 4, 1), after, 1e-6);
  EXPECT_NEAR(error.relative_mse.at(4, 4, 0), after / denominator, 1e-6);
  EXPECT_NEAR(error.mean_relative_mse, after / denominator, 1e-6);
  EXPECT_LE(error.relative_variance.at(4, 4, 0), error.relative_mse.at(4, 4, 0));
}

TEST(LowerError, AQuarterStays) {
  ErrorMap error;
  error.mse = Image(8, 8, 3, Real(0.01));
  error.relative_mse = error.relative_variance = Image(8, 8, 1, Real(0.01));
  lower_error(Image(8, 8, 3, Real(1)), Image(8, 8, 3, Real(3)), Image(8, 8, 1), {}, error);
  EXPECT_EQ(error.prior_share.at(2, 2, 0), Real(1)) << "share was that of the reconstruction: none";
  EXPECT_NEAR(error.mse.at(2, 2, 0), 0.0025, 1e-7);
}

}  // namespace
}  // namespace polyrecon
