#include "blend/blend_windows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "support/images.h"
#include "support/random.h"
#include "support/regression.h"
#include "support/threads.h"

namespace polyrecon {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::image_of;
using test::Random;

constexpr double epsilon = 0.2;

/// Images of one fit: three noisy colours, one AOV, two features. The guide is the other half, too. bound: empty, or as
/// in HalfPair.
struct Pictures {
  Image response, variance, features, guide, guess, bound;

  FitSource source(bool first_stage) const {
    return {&response, &variance, &features, &guide, &variance, first_stage ? nullptr : &guess,
            epsilon,   nullptr,   &guide,    &bound};
  }
};

Pictures make_pictures(int width, int height, std::uint64_t seed, double noise = 0.15) {
  Random random(seed);
  Pictures p;
  p.features = image_of(width, height, 2,
                        [&](int x, int y, int c) { return c == 0 ? ((x / 3 + y / 4) % 2) : 0.5 * random.uniform(); });
  const auto truth = [&](int x, int y, int c) {
    return 1 + 0.4 * std::sin(0.5 * x + 0.3 * y + c) + 0.3 * static_cast<double>(p.features.at(x, y, 0)) +
           0.2 * c * static_cast<double>(p.features.at(x, y, 1));
  };
  p.response = image_of(width, height, 6, [&](int x, int y, int c) {
    return truth(x, y, c % 3) * (c < 3 ? 1 : 0.3) + noise * random.normal();
  });
  p.guide = image_of(width, height, 3, [&](int x, int y, int c) { return truth(x, y, c) + noise * random.normal(); });
  p.guess =
      image_of(width, height, 3, [&](int x, int y, int c) { return truth(x, y, c) + 0.3 * noise * random.normal(); });
  p.variance = Image(width, height, 3, static_cast<Real>(noise * noise));
  return p;
}

std::vector<unsigned char> everywhere(const Image& image) { return std::vector<unsigned char>(image.pixels(), 1); }

std::vector<BlendedFit> fit(const Pictures& p, const FitParams& params, bool first_stage = true) {
  FitCounters counters;
  return fit_and_blend(p.source(first_stage), everywhere(p.response), params, counters, silent_progress());
}

FitParams small_windows() {
  FitParams params;
  params.radius = 3;
  params.stride = 2;
  params.patch.radius = 1;
  params.bandwidths = {Real(0.7), Real(1.2)};
  params.max_order = 2;
  params.coverage = 0;
  return params;
}

/// Equations (2) to (9) in double precision for one centre after the other: distances by their definition, Gram-Schmidt
/// orthogonalisation of the nested columns, explicit error estimates, and the sums of equation (3).
class Reference {
 public:
  Reference(const Pictures& pictures, const FitParams& params, double bandwidth, bool first_stage)
      : p_(pictures),
        params_(params),
        bandwidth_(bandwidth),
        first_(first_stage),
        width_(p_.response.width()),
        height_(p_.response.height()),
        sums_(static_cast<std::size_t>(width_ * height_), VectorXd::Zero(14)) {
    for (int y = 0; y < height_; y += params.stride)
      for (int x = 0; x < width_; x += params.stride) add_window(x, y);
  }
  /// Response 6, squared bias 3, variance 3, order 1 of a pixel.
  VectorXd at(int x, int y) const {
    const VectorXd& s = sums_[static_cast<std::size_t>(y * width_ + x)];
    VectorXd out = s.head(13) / s(13);
    for (int c = 0; c < 3; ++c) out(6 + c) *= out(6 + c) * (out(c) * out(c) + epsilon);
    return out;
  }

 private:
  double distance(int cx, int cy, int x, int y) const {
    const auto at = [&](const Image& image, int u, int v, int c) {
      return static_cast<double>(image.at(std::clamp(u, 0, width_ - 1), std::clamp(v, 0, height_ - 1), c));
    };
    double sum = 0;
    const int r = params_.patch.radius;
    for (int py = -r; py <= r; ++py)
      for (int px = -r; px <= r; ++px) {
        double square = 0, va = 0, vb = 0, floor = 0;
        for (int c = 0; c < 3; ++c) {
          const double a = at(p_.guide, cx + px, cy + py, c), b = at(p_.guide, x + px, y + py, c);
          square += (a - b) * (a - b);
          va += at(p_.variance, cx + px, cy + py, c);
          vb += at(p_.variance, x + px, y + py, c);
          floor += 1e-10 * (a * a + b * b);
        }
        sum += (square - va - std::min(va, vb)) / (va + vb + floor);
      }
    return std::max(sum / ((2 * r + 1) * (2 * r + 1)), 0.0);
  }

  VectorXd columns_at(int cx, int cy, int x, int y) const {
    VectorXd row(1 + 2 + BasisLayout::taylor_terms(params_.max_order));
    int a = 0;
    row(a++) = 1;
    for (int f = 0; f < 2; ++f)
      row(a++) = static_cast<double>(p_.features.at(x, y, f)) - static_cast<double>(p_.features.at(cx, cy, f));
    for (int o = 1; o <= params_.max_order; ++o)
      for (int b = 0; b <= o; ++b)
        row(a++) = std::pow(x - cx, o - b) * std::pow(y - cy, b) / std::pow(params_.radius, o);
    return row;
  }

  void add_window(int cx, int cy) {
    std::vector<int> px, py;
    std::vector<double> weights;
    for (int y = std::max(cy - params_.radius, 0); y <= std::min(cy + params_.radius, height_ - 1); ++y)
      for (int x = std::max(cx - params_.radius, 0); x <= std::min(cx + params_.radius, width_ - 1); ++x) {
        const double e = distance(cx, cy, x, y) / (bandwidth_ * bandwidth_);
        if (e >= 7) continue;
        px.push_back(x);
        py.push_back(y);
        weights.push_back(std::exp(-e));
      }
    const auto n = static_cast<Eigen::Index>(px.size());
    const VectorXd w = VectorXd::Map(weights.data(), n);
    const auto value = [&](const Image& image, int c) {
      VectorXd v(n);
      for (Eigen::Index j = 0; j < n; ++j)
        v(j) = static_cast<double>(image.at(px[static_cast<std::size_t>(j)], py[static_cast<std::size_t>(j)], c));
      return v;
    };
    MatrixXd x(n, columns_at(cx, cy, cx, cy).size());
    for (Eigen::Index j = 0; j < n; ++j)
      x.row(j) = columns_at(cx, cy, px[static_cast<std::size_t>(j)], py[static_cast<std::size_t>(j)]).transpose();
    const MatrixXd q = test::penalised(x, w, {}, 2).q;
    // Factors of the columns, common to the three channels of the beauty.
    const MatrixXd wq = w.asDiagonal() * q;
    VectorXd energy = VectorXd::Zero(q.cols()), noise = energy, g = energy;
    for (int c = 0; c < 3; ++c) {
      const VectorXd z = wq.transpose() * value(p_.response, c),
                     s2 = wq.cwiseAbs2().transpose() * value(p_.variance, c);
      energy += z.cwiseProduct(first_ ? z : wq.transpose() * value(p_.guess, c));
      if (first_) energy -= s2;
      noise += s2;
    }
    for (Eigen::Index a = 0, end; a < q.cols(); a = end) {
      // The constant and the features have a factor each, the Taylor terms of orders 1, 2, ..., from 3, 5, 8, ... on,
      // one per order.
      end = a < 3 ? a + 1 : a == 3 ? 5 : a == 5 ? 8 : q.cols();
      const double e = energy.segment(a, end - a).sum(), v = noise.segment(a, end - a).sum();
      g.segment(a, end - a).setConstant(e > 0 ? e / (e + v) : 0);
    }
    g(0) = 1;
    // Every model in turn, its error by explicit projection.
    VectorXd best_error, best_variance;
    double least = 1e300;
    MatrixXd best_h;
    int best_order = 0;
    const MatrixXd whole = q * wq.transpose();
    for (int model = 0; model <= params_.max_order + 1; ++model) {
      const int columns = model == 0 ? 1 : 3 + BasisLayout::taylor_terms(model - 1);
      const MatrixXd h = q.leftCols(columns) * g.head(columns).asDiagonal() * wq.leftCols(columns).transpose();
      VectorXd error(3), reported(3), variance(3);
      for (int c = 0; c < 3; ++c) {
        const VectorXd y = value(p_.response, c), m = first_ ? y : value(p_.guess, c), v = value(p_.variance, c);
        const auto bias_product = [&](const MatrixXd& projection, const VectorXd& other) {
          return w.dot((projection * m - m).cwiseProduct(projection * other - other));
        };
        variance(c) = w.dot(h.cwiseAbs2() * v);
        // From y and the guess in the columns, from the guess outside of them.
        error(c) = bias_product(h, y) - bias_product(whole, y) + bias_product(whole, m) + variance(c);
        if (first_) error(c) -= w.dot((h - MatrixXd::Identity(n, n)).cwiseAbs2() * v);
        reported(c) = first_ ? error(c) : 0.9 * error(c) + 0.1 * (bias_product(h, m) + variance(c));
      }
      if (error.sum() < least - 1e-9) {
        least = error.sum();
        best_error = reported;
        best_variance = variance;
        best_h = h;
        best_order = std::max(model - 1, 0);
      }
    }
    VectorXd brightness(3), squared_distance = VectorXd::Zero(n);  // squared, of the fit; of the fit to the other half
    MatrixXd yhat(n, 6);
    for (int c = 0; c < 6; ++c) {
      yhat.col(c) = best_h * value(p_.response, c);
      if (c >= 3) continue;
      brightness(c) = w.dot(yhat.col(c).cwiseAbs2()) / w.sum() + epsilon;
      squared_distance += (yhat.col(c) - value(p_.guide, c)).cwiseAbs2();
    }
    VectorXd blended = w;  // weights
    if (!p_.bound.empty()) {
      const VectorXd bound = value(p_.bound, 0);
      blended = w.array() * (1 - (squared_distance.array() / bound.array()).max(1)).exp();
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      VectorXd& s = sum_at(px, py, j);
      s.head(6) += blended(j) * yhat.row(j).transpose();
      for (int c = 0; c < 3; ++c) {
        s(6 + c) += blended(j) * std::sqrt(std::max(best_error(c) - best_variance(c), 0.0) / w.sum() / brightness(c));
        s(9 + c) += blended(j) * best_variance(c) / w.sum();
      }
      s(12) += blended(j) * best_order;
      s(13) += blended(j);
    }
  }

  VectorXd& sum_at(const std::vector<int>& px, const std::vector<int>& py, Eigen::Index j) {
    return sums_[static_cast<std::size_t>(py[static_cast<std::size_t>(j)] * width_ + px[static_cast<std::size_t>(j)])];
  }

  const Pictures& p_;
  const FitParams& params_;
  double bandwidth_;
  bool first_;
  int width_, height_;
  std::vector<VectorXd> sums_;
};

void expect_equation_3(const Pictures& p, const FitParams& params) {
  for (const bool first_stage : {true, false}) {
    const auto fits = fit(p, params, first_stage);
    ASSERT_EQ(fits.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
      const Reference reference(p, params, static_cast<double>(params.bandwidths[k]), first_stage);
      for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 15; ++x) {
          const VectorXd expected = reference.at(x, y);
          SCOPED_TRACE(testing::Message()
                       << "stage " << (first_stage ? 1 : 2) << ", bandwidth " << k << ", pixel " << x << " " << y);
          for (int c = 0; c < 6; ++c) EXPECT_NEAR(static_cast<double>(fits[k].value.at(x, y, c)), expected(c), 2e-5);
          for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(static_cast<double>(fits[k].squared_bias.at(x, y, c)), expected(6 + c), 2e-5);
            EXPECT_NEAR(static_cast<double>(fits[k].variance.at(x, y, c)), expected(9 + c), 2e-5);
          }
          EXPECT_NEAR(static_cast<double>(fits[k].order.at(x, y, 0)), expected(12), 1e-4);
        }
    }
  }
}

TEST(FitAndBlend, IsEquation3OfExplicitWindowsAndFits) { expect_equation_3(make_pictures(15, 11, 1), small_windows()); }

/// exp(1 - d^2 / b) beyond the bound, from bounds that hardly matter to bounds that only the nearest fits keep within.
TEST(FitAndBlend, WindowsCountLessForPixelsThatTheyContradict) {
  Pictures p = make_pictures(15, 11, 6);
  Random random(7);
  p.bound = image_of(15, 11, 1, [&](int, int, int) { return std::pow(10, random.uniform(-1.5, 0)); });
  expect_equation_3(p, small_windows());
}

/// A pixel without noise whose value no window has keeps it; its neighbours are not disturbed.
TEST(FitAndBlend, APixelThatAllWindowsContradictKeepsItsValue) {
  Pictures p = make_pictures(15, 11, 8, 0.01);
  p.bound = Image(15, 11, 1, Real(1));
  const auto before = fit(p, small_windows());
  p.bound.at(7, 5, 0) = 0;
  const auto after = fit(p, small_windows());
  for (int c = 0; c < 3; ++c) EXPECT_EQ(after[0].value.at(7, 5, c), p.response.at(7, 5, c));
  EXPECT_EQ(after[0].value.at(8, 5, 0), before[0].value.at(8, 5, 0));
}

TEST(FitAndBlend, EndlessCoverageMakesEveryPixelACentre) {
  const Pictures p = make_pictures(17, 14, 2);
  FitParams dense = small_windows(), covered = small_windows();
  dense.stride = 1;
  covered.stride = 2;
  covered.coverage = 1e9;
  const auto a = fit(p, dense), b = fit(p, covered);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_LT(test::max_difference(a[k].value, b[k].value), 1e-5);
    EXPECT_LT(test::max_difference(a[k].squared_bias, b[k].squared_bias), 1e-5);
  }
}

/// A flat guide gives all pixels of a window weight 1. The noise variance is so small that shrinkage is below 1e-6.
TEST(Case21, APolynomialOfItsDegreeIsReturned) {
  for (int degree = 0; degree <= 4; ++degree) {
    Pictures p = make_pictures(24, 20, 3);
    p.features = Image(24, 20, 0);
    p.guide = Image(24, 20, 3, Real(1));
    p.variance = Image(24, 20, 3, Real(1e-12));
    p.response = image_of(24, 20, 3, [&](int x, int y, int c) {
      return 2 + c + std::pow((x - 3.0 * c) / 24, degree) - 0.5 * std::pow((x + y) / 30.0, degree);
    });
    FitParams params = small_windows();
    params.radius = 4;
    params.max_order = degree;
    params.coverage = 1;
    EXPECT_LT(test::max_difference(fit(p, params)[0].value, p.response), 1e-5 * test::max_magnitude(p.response))
        << degree;
  }
}

TEST(FitAndBlend, AConstantImageStays) {
  Pictures p = make_pictures(20, 20, 4);
  p.response = Image(20, 20, 3, Real(0.37));
  const auto fits = fit(p, small_windows());
  EXPECT_LT(test::max_difference(fits[0].value, p.response), 1e-6);
}

TEST(FitAndBlend, PixelsThatDoNotMatterKeepTheResponse) {
  const Pictures p = make_pictures(60, 20, 5);
  std::vector<unsigned char> active(p.response.pixels(), 0);
  active[p.response.index(5, 10)] = 1;
  FitCounters counters;
  const FitParams params = small_windows();
  const auto fits = fit_and_blend(p.source(true), active, params, counters, silent_progress());
  EXPECT_NE(fits[0].value.at(5, 10, 0), p.response.at(5, 10, 0));
  EXPECT_EQ(fits[0].value.at(5, 10, 0), fit(p, params)[0].value.at(5, 10, 0));
  // No centre is more than 3 pixels from the active pixel, and no window extends more than 3 pixels from its centre.
  for (int x = 12; x < 60; ++x) EXPECT_EQ(fits[0].value.at(x, 10, 0), p.response.at(x, 10, 0)) << x;
  EXPECT_LE(counters.windows.load(), 2u * 16u);  // both bandwidths, 4 x 4 centres of the even lattice at most
}

TEST(FitAndBlend, CountsEveryWindowOnce) {
  const Pictures p = make_pictures(20, 12, 6);
  FitCounters counters;
  FitParams params = small_windows();
  fit_and_blend(p.source(true), everywhere(p.response), params, counters, silent_progress());
  EXPECT_EQ(counters.windows.load(), 2u * 10u * 6u);
  std::size_t per_model = 0;
  for (const auto& count : counters.per_model) per_model += count;
  EXPECT_EQ(per_model + counters.dropped, counters.windows.load());
  EXPECT_EQ(counters.uncovered_pixels.load(), 0u);
}

TEST(FitAndBlend, HasTheSameBitsForAnyNumberOfThreads) {
  const Pictures p = make_pictures(200, 140, 7);
  FitParams params = small_windows();
  params.coverage = 4;
  const auto once = test::with_threads(1, [&] { return fit(p, params); });
  for (const int threads : {2, 8, 16}) {
    const auto again = test::with_threads(threads, [&] { return fit(p, params); });
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_TRUE(test::same_bits(again[k].value, once[k].value)) << threads;
      EXPECT_TRUE(test::same_bits(again[k].squared_bias, once[k].squared_bias)) << threads;
      EXPECT_TRUE(test::same_bits(again[k].variance, once[k].variance)) << threads;
      EXPECT_TRUE(test::same_bits(again[k].order, once[k].order)) << threads;
    }
  }
}

TEST(FitAndBlend, ACropAlignedToTwoBlocksHasTheSameBitsInside) {
  Pictures p = make_pictures(210, 150, 8);
  p.bound = image_of(210, 150, 1, [](int x, int y, int) { return 0.01 * (1 + (x + y) % 5); });
  for (const int stride : {1, 2, 3, 6, 8}) {
    FitParams params = small_windows();
    params.radius = std::max(3, stride / 2);
    params.stride = stride;
    params.coverage = 3;
    const auto whole = fit(p, params);
    for (const Rect& r : {Rect{128, 0, 210, 150}, Rect{0, 0, 150, 100}, Rect{128, 0, 200, 64}}) {
      const Pictures part{crop(p.response, r), crop(p.variance, r), crop(p.features, r),
                          crop(p.guide, r),    crop(p.guess, r),    crop(p.bound, r)};
      const auto cropped = fit(part, params);
      const int halo = fit_halo(params);
      const Rect inside{r.x0 == 0 ? 0 : r.x0 + halo, r.y0 == 0 ? 0 : r.y0 + halo, r.x1 == 210 ? 210 : r.x1 - halo,
                        r.y1 == 150 ? 150 : r.y1 - halo};
      ASSERT_FALSE(inside.empty()) << stride;
      const Rect within{inside.x0 - r.x0, inside.y0 - r.y0, inside.x1 - r.x0, inside.y1 - r.y0};
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_TRUE(test::same_bits(crop(whole[k].value, inside), crop(cropped[k].value, within))) << stride;
        EXPECT_TRUE(test::same_bits(crop(whole[k].squared_bias, inside), crop(cropped[k].squared_bias, within)))
            << stride;
        EXPECT_TRUE(test::same_bits(crop(whole[k].order, inside), crop(cropped[k].order, within))) << stride;
      }
    }
  }
}

}  // namespace
}  // namespace polyrecon
