#include "estimate/error_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/gaussian.h"
#include "support/images.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

Candidate candidate_of(const Image& a, const Image& b, const Image& error) {
  return {{a, b}, error, test::times(error, 0.5), Image(a.width(), a.height(), 1)};
}

/// The variance of the mean, from that of a half.
Image times_half(const Image& variance) { return test::times(variance, 0.5); }

Image textured(int width, int height) {
  return test::image_of(width, height, 3,
                        [](int x, int y, int c) { return 10 + std::sin(0.9 * x + c) + ((x + y) % 3); });
}

/// A fixed linear smoother on a truth it cannot hold. The estimate's numerator is unbiased for the squared error of the
/// mean of the filtered halves; radiance is large beside noise and floor, so that its division by yhat^2 + 0.01 (which
/// holds noise too) shifts it by far less than the standard error. 200 draws of a 24 x 20 image; 4 standard errors are
/// exceeded by chance once in 16000.
TEST(CrossValidatedError, IsUnbiasedForAFixedLinearSmoother) {
  const Image truth = textured(24, 20);
  const double sigma = 0.6;
  double sum = 0, square = 0;
  const int draws = 200;
  for (int draw = 0; draw < draws; ++draw) {
    const HalfPair pair = test::pair_of(truth, sigma, 1000 + static_cast<std::uint64_t>(draw));
    const Candidate result =
        candidate_of(gaussian_blur(pair.color[0], 1), gaussian_blur(pair.color[1], 1), pair.variance);
    const double estimate = cross_validated_error(pair, Image(24, 20, 3, static_cast<Real>(sigma * sigma / 2)), result);
    double actual = 0;
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < truth.pixels(); ++i) {
        const double f =
            0.5 * (static_cast<double>(result.half[0].plane(c)[i]) + static_cast<double>(result.half[1].plane(c)[i]));
        const double d = f - static_cast<double>(truth.plane(c)[i]);
        actual += d * d / (f * f + 0.01) / (3.0 * static_cast<double>(truth.pixels()));
      }
    sum += estimate - actual;
    square += (estimate - actual) * (estimate - actual);
  }
  const double mean = sum / draws, standard_error = std::sqrt((square / draws - mean * mean) / draws);
  EXPECT_LT(std::abs(mean), 4 * standard_error);
}

TEST(CrossValidatedError, OfOnePixelByHand) {
  // f_A = 1, f_B = 3, A = 2, B = 5, Var 0.5: ((1 - 5)^2 + (3 - 2)^2) / 2 - 0.5 - 4 / 4 = 7 over 2^2 + 0.01. The
  // variance of a half is twice the measured one of the mean, 0.25; the pair's has a floor of 0.8 and is not asked.
  HalfPair pair = test::pair_of(Image(1, 1, 3), 0, 1);
  pair.color = {Image(1, 1, 3, Real(2)), Image(1, 1, 3, Real(5))};
  pair.variance = Image(1, 1, 3, Real(0.8));
  const Candidate result = candidate_of(Image(1, 1, 3, Real(1)), Image(1, 1, 3, Real(3)), Image(1, 1, 3));
  EXPECT_NEAR(cross_validated_error(pair, Image(1, 1, 3, Real(0.25)), result), 7 / 4.01, 1e-9);
  // Where an outlier was replaced the pair's variance is the smaller one, and holds.
  pair.variance = Image(1, 1, 3, Real(0.5));
  EXPECT_NEAR(cross_validated_error(pair, Image(1, 1, 3, Real(100)), result), 7 / 4.01, 1e-9);
}

/// Each pixel: bias^2 = error - variance of the windows, as it is; their variance times one factor, such that its sum
/// is that of (f_A - f_B)^2 / 4, both relative.
TEST(ErrorMap, IsBiasOfTheWindowsAndVarianceOfTheHalves) {
  const Image truth = textured(24, 20);
  const HalfPair pair = test::pair_of(truth, 0.6, 5);
  const Candidate result =
      candidate_of(gaussian_blur(pair.color[0], 1), gaussian_blur(pair.color[1], 1), Image(24, 20, 3, Real(0.2)));
  const ErrorMap map = make_error_map(pair, times_half(pair.variance), result);
  double measured = 0, claimed = 0;
  const auto floor = [&](int x, int y, int c) {
    const double f =
        0.5 * (static_cast<double>(result.half[0].at(x, y, c)) + static_cast<double>(result.half[1].at(x, y, c)));
    return f * f + 0.01;
  };
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x) {
        const double d =
            static_cast<double>(result.half[0].at(x, y, c)) - static_cast<double>(result.half[1].at(x, y, c));
        measured += d * d / 4 / floor(x, y, c);
        claimed += 0.1 / floor(x, y, c);
      }
  EXPECT_NEAR(map.calibration, measured / claimed, 1e-6 * map.calibration);
  double sum = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) {
      double relative = 0, noise = 0;
      for (int c = 0; c < 3; ++c) {
        noise += static_cast<double>(pair.variance.at(x, y, c)) / 2 / floor(x, y, c) / 3;
        const double mse = 0.1 + map.calibration * 0.1;
        EXPECT_NEAR(static_cast<double>(map.mse.at(x, y, c)), mse, 1e-6);
        relative += mse / floor(x, y, c) / 3;
      }
      EXPECT_NEAR(static_cast<double>(map.relative_mse.at(x, y, 0)), relative, 1e-6 * relative);
      EXPECT_NEAR(static_cast<double>(map.relative_noise.at(x, y, 0)), noise, 1e-6 * noise);
      sum += relative;
    }
  EXPECT_NEAR(map.mean_relative_mse, sum / (24 * 20), 1e-6 * map.mean_relative_mse);
}

TEST(ErrorMap, IsFiniteAndNotNegative) {
  const HalfPair pair = test::pair_of(Image(16, 16, 3), 0.1, 6);  // black: yhat about 0
  Candidate result = candidate_of(pair.color[0], pair.color[1], pair.variance);
  result.error.at(3, 3, 0) = 0;  // less than its variance
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

}  // namespace
}  // namespace polyrecon
