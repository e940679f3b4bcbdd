#include "regression/weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

/// The definition in the header, pixel by pixel, in double.
double distance(const Pictures& p, int cx, int cy, int x, int y, int patch_radius) {
  double sum = 0;
  for (int py = -patch_radius; py <= patch_radius; ++py)
    for (int px = -patch_radius; px <= patch_radius; ++px) {
      const auto at = [&](const Image& image, int u, int v, int c) {
        return static_cast<double>(image.at(std::clamp(u + px, 0, width - 1), std::clamp(v + py, 0, height - 1), c));
      };
      double excess = 0, scale = static_cast<double>(std::numeric_limits<Real>::min());
      for (int c = 0; c < 3; ++c) {
        const double a = at(p.guide, cx, cy, c), b = at(p.guide, x, y, c);
        const double va = at(p.variance, cx, cy, c), vb = at(p.variance, x, y, c);
        excess += (a - b) * (a - b) - (va + std::min(va, vb));
        scale += va + vb + 1e-10 * (a * a + b * b);
      }
      sum += excess / scale;
    }
  return sum / ((2 * patch_radius + 1) * (2 * patch_radius + 1));
}

Window window_at(const PatchDistances& distances, std::size_t center, int radius, Real limit) {
  Window window;
  window.reserve(radius, 1, 3);
  distances.window_of(center, limit, window);
  window.padded = (window.count + Window::lanes - 1) / Window::lanes * Window::lanes;
  return window;
}

constexpr Real everything = std::numeric_limits<Real>::max();

/// Checks all windows of the given centres against the definition.
void check(const Pictures& p, const std::vector<int>& cx, const std::vector<int>& cy, int radius, int patch_radius) {
  PatchDistances distances;
  distances.compute(p.guide, p.variance, {0, 0, width, height}, cx, cy, radius, patch_radius);
  for (std::size_t k = 0; k < cx.size(); ++k) {
    const Window window = window_at(distances, k, radius, everything);
    const Rect inside = intersect(grow({cx[k], cy[k], cx[k] + 1, cy[k] + 1}, radius), p.guide.bounds());
    ASSERT_EQ(static_cast<std::size_t>(window.count), inside.area());
    for (std::size_t j = 0; j < inside.area(); ++j) {
      const double expected = std::max(distance(p, cx[k], cy[k], window.x[j], window.y[j], patch_radius), 0.0);
      ASSERT_NEAR(static_cast<double>(window.distance[j]), expected, 1e-5 * std::max(1.0, expected))
          << cx[k] << " " << cy[k] << " -> " << window.x[j] << " " << window.y[j];
    }
  }
}

TEST(PatchDistances, AreTheirDefinitionWhereCentresAreDense) {
  std::vector<int> cx, cy;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      cx.push_back(x);
      cy.push_back(y);
    }
  for (const int patch_radius : {0, 1, 2}) check(noisy_pictures(), cx, cy, 3, patch_radius);
}

TEST(PatchDistances, AreTheirDefinitionWhereCentresAreSparse) {
  // Corners, a border and the middle; 5 centres x 9 pixels of patch are fewer than the block's 143 pixels.
  for (const int patch_radius : {0, 1, 2})
    check(noisy_pictures(), {0, width - 1, 0, width - 1, 6}, {0, 0, height - 1, height - 1, 5}, 3, patch_radius);
}

/// Wide enough for the vector units: there a compiler that fuses products and sums has more than one way to.
TEST(PatchDistances, HaveTheSameBitsWhetherCentresAreDenseOrSparse) {
  test::Random random(4);
  const Image guide = image_of(48, 40, 3, [&](int, int, int) { return 1 + 0.2 * random.normal(); });
  const Image variance = image_of(48, 40, 3, [&](int, int, int) { return 0.04 * (0.5 + random.uniform()); });
  for (const int patch_radius : {0, 1, 2}) {
    std::vector<int> cx, cy;
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 48; ++x) {
        cx.push_back(x);
        cy.push_back(y);
      }
    PatchDistances dense, sparse;
    dense.compute(guide, variance, guide.bounds(), cx, cy, 9, patch_radius);
    for (std::size_t k = 0; k < cx.size(); k += 37) {
      sparse.compute(guide, variance, guide.bounds(), {cx[k]}, {cy[k]}, 9, patch_radius);
      const Window a = window_at(dense, k, 9, everything), b = window_at(sparse, 0, 9, everything);
      ASSERT_EQ(a.count, b.count);
      for (std::size_t j = 0; j < static_cast<std::size_t>(a.count); ++j)
        ASSERT_EQ(a.distance[j], b.distance[j]) << patch_radius;
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
    PatchDistances a, b;
    a.compute(p.guide, p.variance, p.guide.bounds(), {6}, {5}, 4, 1);
    b.compute(scaled.guide, scaled.variance, p.guide.bounds(), {6}, {5}, 4, 1);
    const Window wa = window_at(a, 0, 4, everything), wb = window_at(b, 0, 4, everything);
    ASSERT_EQ(wa.count, wb.count);
    for (std::size_t j = 0; j < static_cast<std::size_t>(wa.count); ++j) EXPECT_EQ(wa.distance[j], wb.distance[j]);
  }
}

TEST(PatchDistances, WithoutNoiseOnlyEqualPatchesAreAlike) {
  // Left half 1, right half 1.001, no variance: alike within each half only, patches that see both halves like their
  // own column.
  const Pictures p{image_of(width, height, 3, [](int x, int, int) { return x < 6 ? 1 : 1.001; }),
                   Image(width, height, 3)};
  PatchDistances distances;
  distances.compute(p.guide, p.variance, p.guide.bounds(), {2}, {5}, 4, 1);
  const Window window = window_at(distances, 0, 4, cut_exponent);
  EXPECT_EQ(window.count, 5 * 9);  // columns 0 to 4: those whose patch lies in the left half
  for (std::size_t j = 0; j < static_cast<std::size_t>(window.count); ++j) {
    EXPECT_LT(window.x[j], 5);
    EXPECT_EQ(window.distance[j], Real(0));
  }
}

TEST(PatchDistances, OfABlackImageAreZero) {
  const Pictures p{Image(width, height, 3), Image(width, height, 3)};
  PatchDistances distances;
  distances.compute(p.guide, p.variance, p.guide.bounds(), {0}, {0}, 2, 1);
  const Window window = window_at(distances, 0, 2, cut_exponent);
  EXPECT_EQ(window.count, 9);
  EXPECT_EQ(window.distance[8], Real(0));
}

TEST(PatchDistances, TheLimitLeavesPixelsOut) {
  const Pictures p = noisy_pictures();
  PatchDistances distances;
  distances.compute(p.guide, p.variance, p.guide.bounds(), {6}, {5}, 3, 1);
  const Window all = window_at(distances, 0, 3, everything), some = window_at(distances, 0, 3, Real(0.5));
  int below = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(all.count); ++j) below += all.distance[j] < Real(0.5);
  EXPECT_EQ(some.count, below);
  EXPECT_GT(below, 0);
  EXPECT_LT(below, all.count);
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
