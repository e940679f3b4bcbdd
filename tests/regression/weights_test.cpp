#include "regression/weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/rect.h"
#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

using test::image_of;

constexpr int width = 13, height = 11;

struct Pictures {
  Image guide, variance;
};

Pictures noisy_pictures(double exposure = 1) {
  test::Random random(3);
  const auto value = [&](int x, int, int) { return exposure * (1 + 0.3 * (x > 6) + 0.2 * random.normal()); };
  const Image guide = image_of(width, height, 3, value);
  return {guide, image_of(width, height, 3,
                          [&](int, int, int) { return exposure * exposure * 0.04 * (0.5 + random.uniform()); })};
}

constexpr Real infinity = std::numeric_limits<Real>::infinity();

/// The definition in the header, pixel by pixel, in double.
double distance(const Pictures& p, int cx, int cy, int x, int y, int patch_radius, Real most_around = infinity) {
  double sum = 0;
  for (int py = -patch_radius; py <= patch_radius; ++py)
    for (int px = -patch_radius; px <= patch_radius; ++px) {
      const auto at = [&](const Image& image, int u, int v, int c) {
        return static_cast<double>(image.at(std::clamp(u + px, 0, width - 1), std::clamp(v + py, 0, height - 1), c));
      };
      double square = 0, va = 0, vb = 0, scale = 2 * static_cast<double>(std::numeric_limits<Real>::min());
      for (int c = 0; c < 3; ++c) {
        const double a = at(p.guide, cx, cy, c), b = at(p.guide, x, y, c);
        square += (a - b) * (a - b);
        va += at(p.variance, cx, cy, c);
        vb += at(p.variance, x, y, c);
        scale += 1e-10 * (a * a + b * b);
      }
      const double difference = (square - (va + std::min(va, vb))) / (scale + va + vb);
      sum += px == 0 && py == 0 ? difference : std::min(difference, static_cast<double>(most_around));
    }
  return sum / ((2 * patch_radius + 1) * (2 * patch_radius + 1));
}

/// The window around a centre, of all pixels whose distance is below limit.
Window window_at(const Pictures& p, int cx, int cy, int radius, int patch_radius, Real limit,
                 Real most_around = infinity) {
  PatchDistances distances;
  distances.load(p.guide, p.variance, {0, 0, width, height}, radius, {patch_radius, most_around});
  Window window;
  window.reserve(radius, 1, 3);
  distances.window_of(cx, cy, {limit}, window);
  window.padded = (window.count + Window::lanes - 1) / Window::lanes * Window::lanes;
  return window;
}

constexpr Real everything = std::numeric_limits<Real>::max();

TEST(PatchDistances, AreTheirDefinition) {
  const Pictures p = noisy_pictures();
  for (const int radius : {1, 3, 9})
    for (const auto& [patch_radius, most] : {std::pair{0, Real(0.5)}, {1, infinity}, {2, infinity}, {2, Real(0.5)}})
      for (int cy = 0; cy < height; ++cy)
        for (int cx = 0; cx < width; ++cx) {
          const Window window = window_at(p, cx, cy, radius, patch_radius, everything, most);
          const Rect inside = intersect(grow({cx, cy, cx + 1, cy + 1}, radius), p.guide.bounds());
          ASSERT_EQ(static_cast<std::size_t>(window.count), inside.area());
          for (std::size_t j = 0; j < inside.area(); ++j) {
            const double expected = std::max(distance(p, cx, cy, window.x[j], window.y[j], patch_radius, most), 0.0);
            ASSERT_NEAR(static_cast<double>(window.distance[j]), expected, 1e-5 * std::max(1.0, expected))
                << cx << " " << cy << " -> " << window.x[j] << " " << window.y[j];
          }
        }
}

TEST(PatchDistances, OfLikePixelsAreZeroOnAverageWhateverTheNoise) {
  // One colour everywhere: E[(a-b)^2] = va + vb, so a distance is 0 on average: here -vmin-vb+va+vb. 27 numbers a
  // patch.
  test::Random random(8);
  const double sigma = 0.5;
  const Pictures p{image_of(width, height, 3, [&](int, int, int) { return 3 + sigma * random.normal(); }),
                   Image(width, height, 3, static_cast<Real>(sigma * sigma))};
  double sum = 0;
  int count = 0;
  for (int y = 1; y < height - 1; ++y)
    for (int x = 4; x < width - 4; ++x) {
      sum += distance(p, x - 3, y, x, y, 1);
      ++count;
    }
  // A term ((a-b)^2 - 2v) / 2v has variance 2; 45 patches of 27 terms overlap 9-fold: about 135 independent terms.
  EXPECT_LT(std::abs(sum / count), 4 * std::sqrt(2.0 / 135));
}

TEST(PatchDistances, HaveTheSameBitsAtAnyExposure) {
  const Pictures p = noisy_pictures();
  for (const double exposure : {0x1p-10, 0x1p10}) {
    const Pictures scaled{test::times(p.guide, exposure), test::times(p.variance, exposure * exposure)};
    const Window wa = window_at(p, 6, 5, 4, 1, everything), wb = window_at(scaled, 6, 5, 4, 1, everything);
    ASSERT_EQ(wa.count, wb.count);
    for (std::size_t j = 0; j < static_cast<std::size_t>(wa.count); ++j) EXPECT_EQ(wa.distance[j], wb.distance[j]);
  }
}

TEST(PatchDistances, WithoutNoiseOnlyEqualPatchesAreAlike) {
  // Left half 1, right half 1.001, no variance: pixels are alike within each half only. A patch across both halves is
  // like those of the same column.
  const Pictures p{image_of(width, height, 3, [](int x, int, int) { return x < 6 ? 1 : 1.001; }),
                   Image(width, height, 3)};
  const Window window = window_at(p, 2, 5, 4, 1, cut_exponent);
  EXPECT_EQ(window.count, 5 * 9);  // columns 0 to 4: those whose patch lies in the left half
  for (std::size_t j = 0; j < static_cast<std::size_t>(window.count); ++j) {
    EXPECT_LT(window.x[j], 5);
    EXPECT_EQ(window.distance[j], Real(0));
  }
}

TEST(PatchDistances, OfABlackImageAreZero) {
  const Pictures p{Image(width, height, 3), Image(width, height, 3)};
  const Window window = window_at(p, 0, 0, 2, 1, cut_exponent);
  EXPECT_EQ(window.count, 9);
  EXPECT_EQ(window.distance[8], Real(0));
}

TEST(PatchDistances, TheLimitLeavesPixelsOut) {
  const Pictures p = noisy_pictures();
  const Window all = window_at(p, 6, 5, 3, 1, everything), some = window_at(p, 6, 5, 3, 1, Real(0.5));
  int below = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(all.count); ++j) below += all.distance[j] < Real(0.5);
  EXPECT_EQ(some.count, below);
  EXPECT_GT(below, 0);
  EXPECT_LT(below, all.count);
}

TEST(PatchDistances, LimitsShareOneList) {
  const Pictures p = noisy_pictures();
  PatchDistances distances;
  distances.load(p.guide, p.variance, {0, 0, width, height}, 4, {1});
  Window all, some;
  all.reserve(4, 1, 3);
  some.reserve(4, 1, 3);
  const std::vector<Real> limits{Real(0.3), Real(0.8), everything};
  distances.window_of(6, 5, limits, all);
  ASSERT_EQ(all.within.size(), 3u);
  EXPECT_LT(all.within[0], all.within[1]);
  EXPECT_LT(all.within[1], all.within[2]);
  EXPECT_EQ(all.within[2], all.count);
  int before = 0;
  for (std::size_t k = 0; k < limits.size(); ++k) {
    distances.window_of(6, 5, {limits[k]}, some);
    EXPECT_EQ(all.within[k], some.count);
    for (; before < all.within[k]; ++before) {
      const auto j = static_cast<std::size_t>(before);
      EXPECT_LT(all.distance[j], limits[k]);
      EXPECT_GE(all.distance[j], k > 0 ? limits[k - 1] : Real(0));
    }
  }
}

TEST(PatchDistances, HaveTheSameBitsInAnyOrderOfTheCentres) {
  const Pictures p = noisy_pictures();
  PatchDistances shared;
  shared.load(p.guide, p.variance, {0, 0, width, height}, 3, {2});
  Window window;
  window.reserve(3, 1, 3);
  const int order[] = {0, 1, 4, 3, 9, 10, 2, 2, 5, 0};  // rows in any order, some twice
  for (const int x : {5, 6, 5})
    for (const int y : order) {
      shared.window_of(x, y, {everything}, window);
      const Window single = window_at(p, x, y, 3, 2, everything);
      ASSERT_EQ(window.count, single.count);
      for (std::size_t j = 0; j < static_cast<std::size_t>(window.count); ++j)
        ASSERT_EQ(window.distance[j], single.distance[j]) << x << " " << y;
    }
}

TEST(KernelWeights, AreTheExponentialCutAtItsEnd) {
  Window window;
  window.reserve(4, 1, 3);
  window.count = 81;
  window.padded = 96;
  for (std::size_t j = 0; j < 81; ++j) window.distance[j] = static_cast<Real>(0.11 * static_cast<double>(j));  // to 8.8
  std::vector<Real> weight(static_cast<std::size_t>(window.stride), Real(-1));
  for (const double h : {0.5, 1.0, 2.0}) {
    const double sum = kernel_weights(window, static_cast<Real>(h), weight.data());
    double expected_sum = 0;
    for (std::size_t j = 0; j < 96; ++j) {
      const double e = j < 81 ? static_cast<double>(window.distance[j]) / (h * h) : 1e9;
      const double expected = e < static_cast<double>(cut_exponent) ? std::exp(-e) : 0;
      EXPECT_NEAR(static_cast<double>(weight[j]), expected, 1e-6 * expected) << h << " " << j;
      expected_sum += static_cast<double>(weight[j]);
    }
    EXPECT_DOUBLE_EQ(sum, expected_sum);
  }
}

}  // namespace
}  // namespace polyrecon
