#include "noise/variance.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/gaussian.h"
#include "core/halves.h"
#include "core/parallel.h"
#include "core/real.h"
#include "core/rect.h"
#include "core/repair.h"
#include "noise/spike_variance.h"
#include "regression/least_squares.h"

namespace polyrecon {
namespace {

constexpr int fit_radius = 3, fit_stride = 2, vote_radius = 2;
constexpr double texture_correlation = 0.5;  // of neighbours, in what a fit leaves of texture
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

/// Calls of(i, j) for each two pixels of a window, rows of `width` pixels, that stand side by side or one above the
/// other; returns their number.
template <typename Of>
int for_neighbours(const Rect& area, const Of& of) {
  const int width = area.width(), height = area.height();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y * width + x);
      if (x + 1 < width) of(i, i + 1);
      if (y + 1 < height) of(i, i + static_cast<std::size_t>(width));
    }
  return (width - 1) * height + width * (height - 1);
}

/// Mean of H over the pairs of neighbours.
double neighbours_in_hat(const NestedFactor& factor, const Window& window, const Rect& area) {
  double sum = 0;
  const auto pitch = static_cast<std::size_t>(window.pitch);
  const int pairs = for_neighbours(area, [&](std::size_t i, std::size_t j) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(factor.kept); ++k)
      sum += static_cast<double>(factor.q[i * pitch + k]) * static_cast<double>(factor.q[j * pitch + k]);
  });
  return pairs > 0 ? sum / pairs : 0;
}

/// y less the fit, pixel by pixel: |y|^2 - sum z^2 would cancel to the rounding of q where the noise is small beside
/// the light.
void residuals_of(const NestedFactor& factor, const Window& window, const std::vector<Real>& weight, int channel,
                  std::vector<double>& rest) {
  const Real* values =
      window.response.data() + static_cast<std::size_t>(channel) * static_cast<std::size_t>(window.stride);
  std::array<double, BasisLayout::max_columns> z{};
  project(factor, window, weight.data(), values, z.data());
  rest.resize(static_cast<std::size_t>(window.count));
  for (std::size_t j = 0; j < rest.size(); ++j) {
    rest[j] = static_cast<double>(values[j]);
    for (std::size_t k = 0; k < static_cast<std::size_t>(factor.kept); ++k)
      rest[j] -= z[static_cast<std::size_t>(factor.kept_column[k])] *
                 static_cast<double>(factor.q[j * static_cast<std::size_t>(window.pitch) + k]);
  }
}

/// Variance of the noise in the residuals of a fit (variance.h).
double noise_in(const std::vector<double>& rest, const Rect& area, double freedom, double hat) {
  double squares = 0, covariance = 0;
  for (const double r : rest) squares += r * r;
  const int pairs = for_neighbours(area, [&](std::size_t i, std::size_t j) { covariance += rest[i] * rest[j]; });
  if (pairs > 0) covariance /= pairs;
  return std::max((squares / freedom - covariance / texture_correlation) / (1 + hat / texture_correlation), 0.0);
}

/// What the threads of estimate_variance work with.
struct Scratch {
  Window window;
  NestedFactor factor;
  std::vector<Real> weight;
  std::vector<double> rest;
};

/// Variance of the noise per channel by the fit around a centre; -1 where there are too few pixels for the columns.
void fit_noise(const Image& y, const Image& features, int cx, int cy, Scratch& s, Real* out) {
  const BasisLayout layout(features.channels(), 1);
  Window& window = s.window;
  window.reserve(fit_radius, layout.columns(), y.channels());
  s.weight.assign(static_cast<std::size_t>(window.stride), Real(0));
  window.count = 0;
  const Rect area = intersect(grow({cx, cy, cx + 1, cy + 1}, fit_radius), y.bounds());
  for (int v = area.y0; v < area.y1; ++v)
    for (int u = area.x0; u < area.x1; ++u) {
      const auto j = static_cast<std::size_t>(window.count++);
      window.x[j] = u;
      window.y[j] = v;
      s.weight[j] = 1;
    }
  gather({&y, &y, &features, nullptr}, layout, cx, cy, fit_radius, window);
  factorise(window, window.layout.columns(), s.weight.data(), s.factor);
  const double freedom = window.count - degrees_of_freedom(s.factor, window);
  const double hat = neighbours_in_hat(s.factor, window, area);
  for (int c = 0; c < y.channels(); ++c) {
    residuals_of(s.factor, window, s.weight, c, s.rest);
    out[c] = freedom > 0.5 ? storable(noise_in(s.rest, area, freedom, hat)) : Real(-1);
  }
}

/// As many features as the local model holds, in the frame's order.
Image repaired_features(const Frame& frame) {
  std::vector<const Image*> used;
  int channels = 0;
  for (const Feature& feature : frame.features) {
    const Image& mean = feature.pass.mean;
    if (channels + mean.channels() > BasisLayout::max_features) continue;
    channels += mean.channels();
    used.push_back(&mean);
  }
  Image out(frame.width(), frame.height(), channels);
  int channel = 0;
  for (const Image* feature : used) {
    Image mean = *feature;
    repair_nonfinite(mean, 1);
    for (int c = 0; c < mean.channels(); ++c, ++channel)
      std::copy(mean.plane(c), mean.plane(c) + mean.pixels(), out.plane(channel));
  }
  return out;
}

/// The noise that remains where rounding to half floats, whose error is at most 2^-11 of the value, explains none of
/// it.
Real beyond_rounding(Real variance, Real value) {
  const Real rounding = value * Real(half_float_rounding);
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
    for (std::size_t i = 0; i < out.pixels(); ++i)
      out.plane(c)[i] = variance_of_mean(beauty.half_a.plane(c)[i], beauty.half_b.plane(c)[i]);
  repair_nonfinite(out, 2);
  return gaussian_blur(out, half_difference_sigma);
}

}  // namespace

bool noise_is_measured(const Frame& frame) { return frame.beauty.noise_is_told(); }

bool variance_is_estimated(FeatureKind kind, bool told) { return !told && kind != FeatureKind::Depth; }

Image estimate_variance(const Image& y, const Image& features, Progress& progress) {
  Image fits((y.width() + fit_stride - 1) / fit_stride, (y.height() + fit_stride - 1) / fit_stride, y.channels());
  parallel_for(static_cast<std::size_t>(fits.height()), progress, [&](std::size_t row) {
    Scratch scratch;
    std::vector<Real> variance(static_cast<std::size_t>(y.channels()));
    for (int x = 0; x < fits.width(); ++x) {
      fit_noise(y, features, x * fit_stride, static_cast<int>(row) * fit_stride, scratch, variance.data());
      for (int c = 0; c < y.channels(); ++c)
        fits.at(x, static_cast<int>(row), c) = variance[static_cast<std::size_t>(c)];
    }
  });
  Image out = spike_variance(y);
  parallel_for(static_cast<std::size_t>(out.height()), progress, [&](std::size_t row) {
    const int v = static_cast<int>(row);
    for (int c = 0; c < y.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const Real value = y.at(x, v, c), noise = std::max(vote(fits, x, v, c), out.at(x, v, c));
        out.at(x, v, c) = value == 0 ? Real(0) : beyond_rounding(noise, value);
      }
  });
  return out;
}

NoiseVariance noise_variance(const Frame& frame, Progress& progress) {
  if (!frame.beauty.variance.empty()) return {frame.beauty.variance, "from the file", true};
  if (frame.beauty.has_halves()) return {variance_from_halves(frame.beauty), "from the half buffers", true};
  Image y = frame.beauty.mean;
  repair_nonfinite(y, 2);
  return {estimate_variance(y, repaired_features(frame), progress), "estimated from the image", false};
}

void estimate_feature_variance(Frame& frame, Progress& progress) {
  for (Feature& feature : frame.features) {
    if (!variance_is_estimated(feature.kind, feature.pass.noise_is_told())) continue;
    Image mean = feature.pass.mean;
    repair_nonfinite(mean, 2);
    feature.pass.variance = estimate_variance(mean, Image(mean.width(), mean.height(), 0), progress);
    feature.pass.variance_is_estimated = true;
  }
}

}  // namespace polyrecon
