#include "blend/select.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/gaussian.h"
#include "support/images.h"
#include "support/random.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

using test::image_of;

Candidate candidate_of(const Image& a, const Image& b, Real label, Real variance = Real(0.7)) {
  return {{a, b},
          Image(a.width(), a.height(), 3, label),
          Image(a.width(), a.height(), 3, variance),
          Image(a.width(), a.height(), 1, label)};
}

TEST(Select, TakesTheClearlyBetterCandidateInEachHalfOfTheImage) {
  const int width = 80, height = 24;
  const Image truth = image_of(width, height, 3, [](int x, int y, int c) { return 1 + 0.01 * x + 0.02 * y + 0.1 * c; });
  const HalfPair pair = test::pair_of(truth, 0.3, 1);
  const auto off = [&](bool left) {
    return image_of(width, height, 3, [&](int x, int y, int c) {
      return static_cast<double>(truth.at(x, y, c)) + ((x < 40) == left ? 0.5 : 0);
    });
  };
  const Image bad_left = off(true), bad_right = off(false);
  const Candidate out =
      select(pair, truth, {candidate_of(bad_left, bad_left, 1), candidate_of(bad_right, bad_right, 3)}, SelectParams{});
  // Risks are averaged over 4 pixels and shares over 1.5: outside of the radius of both around the seam, one candidate
  // has the whole share.
  const int margin = gaussian_radius(4) + gaussian_radius(1.5);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (std::abs(x - 40) <= margin) continue;
      EXPECT_NEAR(static_cast<double>(out.order.at(x, y, 0)), x < 40 ? 3 : 1, 1e-3) << x << " " << y;
      EXPECT_NEAR(static_cast<double>(out.half[0].at(x, y, 1)), static_cast<double>(truth.at(x, y, 1)), 1e-3);
    }
}

TEST(Select, OfCandidatesEquallyNearTheLessNoisyCountsMore) {
  // The same pixels twice: z = 0, shares are as 1 / s = 1 : 1 / 2.
  const Image truth(20, 20, 3, Real(1));
  const HalfPair pair = test::pair_of(truth, 0.3, 5), fit = test::pair_of(truth, 0.1, 6);
  const Candidate out = select(pair, truth,
                               {candidate_of(fit.color[0], fit.color[1], 0, Real(0.01)),
                                candidate_of(fit.color[0], fit.color[1], 3, Real(0.04))},
                               SelectParams{});
  EXPECT_LT(test::max_difference(out.order, Image(20, 20, 1, Real(1))), 1e-5);  // 2/3 x 0 + 1/3 x 3
}

TEST(Select, SharesSumToOne) {
  // Candidates that differ by noise only share every pixel; a quantity on which they agree comes through unchanged.
  const Image truth(30, 20, 3, Real(1));
  const HalfPair pair = test::pair_of(truth, 0.3, 2);
  std::vector<Candidate> candidates;
  for (std::uint64_t k = 0; k < 4; ++k) {
    const HalfPair noisy = test::pair_of(truth, 0.05, 10 + k);
    candidates.push_back(candidate_of(noisy.color[0], noisy.color[1], Real(0.7)));
  }
  const Candidate out = select(pair, truth, candidates, SelectParams{});
  EXPECT_LT(test::max_difference(out.squared_bias, Image(30, 20, 3, Real(0.7))), 1e-6);
  EXPECT_LT(test::max_difference(out.variance, Image(30, 20, 3, Real(0.7))), 1e-6);
  EXPECT_LT(test::max_difference(out.order, Image(30, 20, 1, Real(0.7))), 1e-6);
}

TEST(Select, OneCandidateIsTheResult) {
  const Image truth(9, 7, 3, Real(1));
  const HalfPair pair = test::pair_of(truth, 0.3, 3), other = test::pair_of(truth, 0.1, 4);
  const Candidate out = select(pair, truth, {candidate_of(other.color[0], other.color[1], 2)}, SelectParams{});
  EXPECT_TRUE(test::same_bits(out.half[0], other.color[0]));
  EXPECT_TRUE(test::same_bits(out.half[1], other.color[1]));
}

/// Three pixels in a row, one pixel wide, all three channels alike: risk and shares worked out one after the other in
/// double.
TEST(Select, RiskAndSharesOfThreePixelsByHand) {
  const double a[] = {1.0, 1.4, 0.7}, b[] = {1.2, 0.9, 1.1}, brightness[] = {1.0, 2.0, 0.5};
  const double variance[] = {0.02, 0.05};  // of each candidate
  const double f[2][2][3] = {{{1.1, 1.1, 1.1}, {1.0, 0.7, 0.9}},
                             {{0.8, 1.1, 1.3}, {1.3, 1.3, 1.3}}};  // candidate, half, pixel
  const auto row = [](const double* v) { return image_of(1, 3, 3, [v](int, int y, int) { return v[y]; }); };
  HalfPair pair;
  pair.color = {row(a), row(b)};
  pair.variance = Image(1, 3, 3, Real(0.01));
  pair.features = {Image(1, 3, 0), Image(1, 3, 0)};
  pair.epsilon = 0.1;
  SelectParams params;
  params.risk_sigma = 0.7;
  params.map_sigma = 0.8;

  const auto blur = [](const double* v, double sigma, double* out) {
    for (int i = 0; i < 3; ++i) {
      double sum = 0, weight = 0;
      for (int j = 0; j < 3; ++j) {
        const double t = std::exp(-0.5 * (i - j) * (i - j) / (sigma * sigma));
        sum += t * v[j];
        weight += t;
      }
      out[i] = sum / weight;
    }
  };
  double square[3], scale[3], raw[2][3], risk[2][3], share[2][3], smooth[2][3];
  for (int i = 0; i < 3; ++i) square[i] = brightness[i] * brightness[i];
  blur(square, 1, scale);
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < 3; ++i) {
      const double fa = f[k][0][i], fb = f[k][1][i];
      const double error = ((fa - b[i]) * (fa - b[i]) + (fb - a[i]) * (fb - a[i])) / 2 - (fa - fb) * (fa - fb) / 4;
      raw[k][i] = error / (scale[i] + pair.epsilon);
    }
    blur(raw[k], params.risk_sigma, risk[k]);
  }
  bool both = false;
  for (int i = 0; i < 3; ++i) {
    const int best = risk[1][i] < risk[0][i] ? 1 : 0, other = 1 - best;
    // Standard error of the difference under the window of pixel i; the best may change from pixel to pixel.
    double d[3], d2[3], mean[3], mean2[3];
    for (int j = 0; j < 3; ++j) {
      const int best_there = risk[1][j] < risk[0][j] ? 1 : 0;
      d[j] = raw[other][j] - raw[best_there][j];
      d2[j] = d[j] * d[j];
    }
    blur(d, params.risk_sigma, mean);
    blur(d2, params.risk_sigma, mean2);
    const double se =
        std::sqrt(std::max(0.0, mean2[i] - mean[i] * mean[i]) / (4 * M_PI * params.risk_sigma * params.risk_sigma));
    share[best][i] = 1;
    const double z = (risk[other][i] - risk[best][i]) / se;
    share[other][i] = std::exp(-0.5 * z * z);
    both |= share[other][i] > 0.01 && share[other][i] < 0.99;
  }
  ASSERT_TRUE(both) << "the case must have a pixel that is shared";
  for (int k = 0; k < 2; ++k) {
    double relative[3], noise[3];
    for (int i = 0; i < 3; ++i) relative[i] = 3 * variance[k] / (scale[i] + pair.epsilon);
    blur(relative, params.risk_sigma, noise);
    for (int i = 0; i < 3; ++i) share[k][i] /= std::sqrt(noise[i]);
    blur(share[k], params.map_sigma, smooth[k]);
  }

  const Candidate out = select(pair, row(brightness),
                               {candidate_of(row(f[0][0]), row(f[0][1]), 0, Real(variance[0])),
                                candidate_of(row(f[1][0]), row(f[1][1]), 1, Real(variance[1]))},
                               params);
  for (int i = 0; i < 3; ++i) {
    const double s = smooth[1][i] / (smooth[0][i] + smooth[1][i]);
    EXPECT_NEAR(static_cast<double>(out.variance.at(0, i, 1)), (1 - s) * variance[0] + s * variance[1], 1e-5) << i;
    EXPECT_NEAR(static_cast<double>(out.squared_bias.at(0, i, 1)), s * s, 1e-4) << i;  // of biases 0 and 1
    EXPECT_NEAR(static_cast<double>(out.order.at(0, i, 0)), s, 1e-4) << i;
    for (std::size_t h = 0; h < 2; ++h)
      EXPECT_NEAR(static_cast<double>(out.half[h].at(0, i, 2)), (1 - s) * f[0][h][i] + s * f[1][h][i], 1e-4) << i;
  }
}

/// One correction is as good as the result itself, so that shares depend on the last digits of the risks.
TEST(SelectCorrection, TheTilesDoNotShow) {
  const Image truth =
      image_of(150, 130, 3, [](int x, int y, int c) { return 1 + 0.3 * std::sin(0.3 * x + 0.1 * c * y); });
  const HalfPair pair = test::pair_of(truth, 0.3, 11);
  const double sigma = 2;
  const auto make = [&](const std::array<Image, 2>& halves, const Rect&) {
    const std::array<Image, 2> blurred{gaussian_blur(halves[0], sigma), gaussian_blur(halves[1], sigma)};
    return std::vector<std::array<Image, 2>>{{test::times(halves[0], 1.0001), test::times(halves[1], 1.0001)}, blurred};
  };
  const Corrections corrections{2, gaussian_radius(sigma), make};
  const auto work = [&](std::size_t side) {
    const std::size_t bytes = side * side * correction_bytes_per_pixel(3, 2);
    return select_correction(pair, pair.color, corrections, SelectParams{}, bytes);
  };
  const std::array<Image, 2> whole = work(1000);
  EXPECT_GT(test::max_difference(whole[0], pair.color[0]), 0.1);
  for (const std::size_t side : {80u, 110u})
    for (std::size_t h = 0; h < 2; ++h) EXPECT_TRUE(test::same_bits(work(side)[h], whole[h])) << side;
}

}  // namespace
}  // namespace polyrecon
