#include "estimate/variance.h"

#include <algorithm>

#include "core/gaussian.h"
#include "core/parallel.h"
#include "core/sanitise.h"
#include "regression/least_squares.h"

namespace polyrecon {
namespace {

constexpr int fit_radius = 3, fit_stride = 2, vote_radius = 2;
constexpr double half_difference_sigma =
    1.5;  // pixels over which (A - B)^2 is averaged: one of them alone has one degree of freedom

/// Of a fit whose weights are 1: the trace of H, which is the rank but for columns that count in part.
double degrees_of_freedom(const NestedFactor& factor, const Window& window) {
  double trace = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(window.count); ++j)
    for (std::size_t k = 0; k < static_cast<std::size_t>(factor.kept); ++k) {
      const double q = factor.q[j * static_cast<std::size_t>(window.pitch) + k];
      trace += q * q;
    }
  return trace;
}

/// Residual variance per channel of the fit around a centre; -1 where there are too few pixels for the columns.
void residual_variance(const Image& y, const Image& features, int cx, int cy, Window& window, NestedFactor& factor,
                       std::vector<Real>& weight, Real* out) {
  const BasisLayout layout(features.channels(), 1);
  window.reserve(fit_radius, layout.columns(), 3);
  weight.assign(static_cast<std::size_t>(window.stride), Real(0));
  window.count = 0;
  const Rect area = intersect(grow({cx, cy, cx + 1, cy + 1}, fit_radius), y.bounds());
  for (int v = area.y0; v < area.y1; ++v)
    for (int u = area.x0; u < area.x1; ++u) {
      const auto j = static_cast<std::size_t>(window.count++);
      window.x[j] = u;
      window.y[j] = v;
      weight[j] = 1;
    }
  gather({&y, &y, &features, nullptr}, layout, cx, cy, fit_radius, window);
  factorise(window, window.layout.columns(), weight.data(), factor);
  const double freedom = window.count - degrees_of_freedom(factor, window);
  std::array<double, BasisLayout::max_columns> z{};
  for (int c = 0; c < 3; ++c) {
    const Real* values = window.response.data() + static_cast<std::size_t>(c) * static_cast<std::size_t>(window.stride);
    project(factor, window, weight.data(), values, z.data());
    // Summed pixel by pixel: |y|^2 - sum z^2 cancels to the rounding of q where the noise is small beside the light.
    double residual = 0;
    for (std::size_t j = 0; j < static_cast<std::size_t>(window.count); ++j) {
      double rest = static_cast<double>(values[j]);
      for (std::size_t k = 0; k < static_cast<std::size_t>(factor.kept); ++k)
        rest -= z[static_cast<std::size_t>(factor.kept_column[k])] *
                static_cast<double>(factor.q[j * static_cast<std::size_t>(window.pitch) + k]);
      residual += rest * rest;
    }
    out[c] = freedom > 0.5 ? static_cast<Real>(residual / freedom) : Real(-1);
  }
}

/// As many features as the local model holds, in the frame's order.
Image mended_features(const Frame& frame) {
  std::vector<const Image*> used;
  int channels = 0;
  for (const Feature& feature : frame.features) {
    const Image& mean = feature.pass.mean;
    if (channels + mean.channels() > max_feature_channels) continue;
    channels += mean.channels();
    used.push_back(&mean);
  }
  Image out(frame.width(), frame.height(), channels);
  int channel = 0;
  for (const Image* feature : used) {
    Image mean = *feature;
    mend(mean, 1);
    for (int c = 0; c < mean.channels(); ++c, ++channel)
      std::copy(mean.plane(c), mean.plane(c) + mean.pixels(), out.plane(channel));
  }
  return out;
}

/// The noise that remains where rounding to half floats, whose error is at most 2^-11 of the value, explains none of
/// it.
Real beyond_rounding(Real variance, Real value) {
  const Real rounding = value * Real(0x1p-11);
  return variance > rounding * rounding ? variance : 0;
}

/// Median over the fits within vote_radius (in fits) of pixel (x, y).
Real vote(const Image& fits, int x, int y, int c) {
  const int fx = x / fit_stride, fy = y / fit_stride;
  const Rect area = intersect(grow({fx, fy, fx + 1, fy + 1}, vote_radius), fits.bounds());
  std::vector<Real> votes;
  for (int v = area.y0; v < area.y1; ++v)
    for (int u = area.x0; u < area.x1; ++u)
      if (fits.at(u, v, c) >= 0) votes.push_back(fits.at(u, v, c));
  if (votes.empty()) return 0;
  const auto middle = votes.begin() + static_cast<std::ptrdiff_t>(votes.size() / 2);
  std::nth_element(votes.begin(), middle, votes.end());
  return *middle;
}

Image variance_from_halves(const Pass& beauty) {
  Image out = beauty.half_a;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i) {
      const Real d = beauty.half_a.plane(c)[i] - beauty.half_b.plane(c)[i];
      out.plane(c)[i] = d * d / 4;
    }
  mend(out, 2);
  return gaussian_blur(out, half_difference_sigma);
}

}  // namespace

bool noise_is_measured(const Frame& frame) { return !frame.beauty.variance.empty() || frame.beauty.has_halves(); }

NoiseVariance noise_variance(const Frame& frame, Progress& progress) {
  if (!frame.beauty.variance.empty()) return {frame.beauty.variance, "from the file", true};
  if (frame.beauty.has_halves()) return {variance_from_halves(frame.beauty), "from the half buffers", true};
  return {estimate_variance(frame, progress), "estimated from the image", false};
}

Image estimate_variance(const Frame& frame, Progress& progress) {
  Image y = frame.beauty.mean;
  mend(y, 2);
  const Image features = mended_features(frame);
  Image fits((frame.width() + fit_stride - 1) / fit_stride, (frame.height() + fit_stride - 1) / fit_stride, 3);
  parallel_for(static_cast<std::size_t>(fits.height()), progress, [&](std::size_t row) {
    Window window;
    NestedFactor factor;
    std::vector<Real> weight;
    Real variance[3];
    for (int x = 0; x < fits.width(); ++x) {
      residual_variance(y, features, x * fit_stride, static_cast<int>(row) * fit_stride, window, factor, weight,
                        variance);
      for (int c = 0; c < 3; ++c) fits.at(x, static_cast<int>(row), c) = variance[c];
    }
  });
  Image out(frame.width(), frame.height(), 3);
  parallel_for(static_cast<std::size_t>(out.height()), progress, [&](std::size_t row) {
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < out.width(); ++x)
        out.at(x, static_cast<int>(row), c) =
            beyond_rounding(vote(fits, x, static_cast<int>(row), c), y.at(x, static_cast<int>(row), c));
  });
  return out;
}

}  // namespace polyrecon
