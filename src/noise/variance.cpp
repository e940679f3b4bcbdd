#include "noise/variance.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/gaussian.h"
#include "core/halves.h"
#include "core/parallel.h"
#include "core/picture_mask.h"
#include "core/real.h"
#include "core/rect.h"
#include "core/repair.h"
#include "noise/edge_variance.h"
#include "noise/feature_noise.h"
#include "noise/lattice.h"
#include "noise/spike_variance.h"
#include "regression/least_squares.h"

namespace polyrecon {
namespace {

constexpr int fit_radius = 3;
constexpr double texture_correlation = 0.5;    // a in variance.h
constexpr double half_difference_sigma = 1.5;  // pixels; the variance from the halves of one pixel has one degree of
                                               // freedom, so it is averaged by a Gaussian

/// The trace of H for a fit whose weights are all 1: the rank, but for columns that count in part.
double degrees_of_freedom(const NestedFactor& factor, const Window& window) {
  double trace = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(window.count); ++j)
    for (std::size_t k = 0; k < static_cast<std::size_t>(factor.kept); ++k) {
      const double q = factor.q[j * static_cast<std::size_t>(window.pitch) + k];
      trace += q * q;
    }
  return trace;
}

/// The pixels of an area that are in a window: their places in it, row by row; -1 for pixels outside the picture.
struct Places {
  Rect area;
  std::array<int, std::size_t{2 * fit_radius + 1} * std::size_t{2 * fit_radius + 1}> place;
  bool whole = true;  ///< No pixel is outside the picture, so each place is its index.
};

template <typename Visit>
void for_pairs(int width, int height, const Visit& visit) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int i = y * width + x;
      if (x + 1 < width) visit(i, i + 1);
      if (y + 1 < height) visit(i, i + width);
    }
}

/// Calls body(i, j) for each pair of horizontal or vertical neighbours of a window. Returns the number of pairs.
template <typename Body>
int for_neighbours(const Places& places, const Body& body) {
  const int width = places.area.width(), height = places.area.height();
  if (places.whole) {
    for_pairs(width, height, [&](int i, int j) { body(static_cast<std::size_t>(i), static_cast<std::size_t>(j)); });
    return (width - 1) * height + width * (height - 1);
  }
  int pairs = 0;
  for_pairs(width, height, [&](int a, int b) {
    const int i = places.place[static_cast<std::size_t>(a)], j = places.place[static_cast<std::size_t>(b)];
    if (i < 0 || j < 0) return;
    body(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    ++pairs;
  });
  return pairs;
}

/// Mean of H over the pairs of neighbours: h in variance.h.
double mean_hat_of_neighbours(const NestedFactor& factor, const Window& window, const Places& places) {
  double sum = 0;
  const auto pitch = static_cast<std::size_t>(window.pitch);
  const int pairs = for_neighbours(places, [&](std::size_t i, std::size_t j) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(factor.kept); ++k)
      sum += static_cast<double>(factor.q[i * pitch + k]) * static_cast<double>(factor.q[j * pitch + k]);
  });
  return pairs > 0 ? sum / pairs : 0;
}

/// Computes y minus the fit pixel by pixel. The sum |y|^2 - sum z^2 would be faster, but it cancels to the rounding of
/// q where the noise is small compared with the radiance.
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

/// Variance N of the noise in the residuals of a fit; see variance.h.
double noise_in(const std::vector<double>& rest, const Places& places, double freedom, double hat) {
  double squares = 0, covariance = 0;
  for (const double r : rest) squares += r * r;
  const int pairs = for_neighbours(places, [&](std::size_t i, std::size_t j) { covariance += rest[i] * rest[j]; });
  if (pairs > 0) covariance /= pairs;
  return std::max((squares / freedom - covariance / texture_correlation) / (1 + hat / texture_correlation), 0.0);
}

/// Buffers of one thread.
struct Scratch {
  Window window;
  NestedFactor factor;
  std::vector<Real> weight;
  std::vector<double> rest;
};

/// Estimates the variance of the noise per channel from the fit around a centre; -1 where the window has too few pixels
/// for the columns, or its centre is outside the picture.
void fit_noise(const Image& y, const Image& features, const Image& picture, int cx, int cy, Scratch& s, Real* out) {
  if (!in_picture(picture, y.index(cx, cy))) {
    std::fill_n(out, y.channels(), Real(-1));
    return;
  }
  const BasisLayout layout(features.channels(), 1);
  Window& window = s.window;
  window.reserve(fit_radius, layout.columns(), y.channels());
  s.weight.assign(static_cast<std::size_t>(window.stride), Real(0));
  window.count = 0;
  Places places{intersect(grow({cx, cy, cx + 1, cy + 1}, fit_radius), y.bounds()), {}, true};
  auto place = places.place.begin();
  for (int v = places.area.y0; v < places.area.y1; ++v)
    for (int u = places.area.x0; u < places.area.x1; ++u) {
      *place = in_picture(picture, y.index(u, v)) ? window.count : -1;
      if (*place++ < 0) {
        places.whole = false;
        continue;
      }
      const auto j = static_cast<std::size_t>(window.count++);
      window.x[j] = u;
      window.y[j] = v;
      s.weight[j] = 1;
    }
  gather({&y, &y, &features, nullptr}, layout, cx, cy, fit_radius, window);
  factorise(window, window.layout.columns(), s.weight.data(), s.factor);
  const double freedom = window.count - degrees_of_freedom(s.factor, window);
  const double hat = mean_hat_of_neighbours(s.factor, window, places);
  for (int c = 0; c < y.channels(); ++c) {
    residuals_of(s.factor, window, s.weight, c, s.rest);
    out[c] = freedom > 0.5 ? storable(noise_in(s.rest, places, freedom, hat)) : Real(-1);
  }
}

/// A feature that explains the beauty, repaired. Where a variation is noise, it would explain the beauty's noise, as
/// the same samples make both.
Image explaining(const Pass& feature, const Image& picture) {
  Image mean = feature.mean;
  repair_nonfinite(mean, 1);
  if (!feature.variance_is_estimated) return mean;
  const Image part = noise_in_variation(mean, feature.variance, picture);
  return flattened(std::move(mean), part, picture);
}

/// The features that fit into the local model, in the frame's order.
Image explaining_features(const Frame& frame, const Image& picture) {
  std::vector<const Pass*> used;
  int channels = 0;
  for (const Feature& feature : frame.features) {
    const int more = feature.pass.mean.channels();
    if (channels + more > BasisLayout::max_features) continue;
    channels += more;
    used.push_back(&feature.pass);
  }
  Image out(frame.width(), frame.height(), channels);
  int channel = 0;
  for (const Pass* feature : used) {
    const Image mean = explaining(*feature, picture);
    for (int c = 0; c < mean.channels(); ++c, ++channel)
      std::copy(mean.plane(c), mean.plane(c) + mean.pixels(), out.plane(channel));
  }
  return out;
}

/// The variance, or 0 where rounding to half floats, with its error of at most 2^-11 of the value, explains it.
Real beyond_rounding(Real variance, Real value) {
  const Real rounding = value * Real(half_float_rounding);
  return variance > rounding * rounding ? variance : 0;
}

Image variance_from_halves(const Pass& beauty, const Image& picture) {
  Image out = beauty.half_a;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i)
      out.plane(c)[i] = variance_of_mean(beauty.half_a.plane(c)[i], beauty.half_b.plane(c)[i]);
  repair_nonfinite(out, 2);
  return gaussian_blur(out, half_difference_sigma, picture);
}

}  // namespace

bool noise_is_measured(const Frame& frame) { return frame.beauty.noise_is_known(); }

Image estimate_variance(const Image& y, const Image& features, Progress& progress, const Image& picture,
                        const Image& samples) {
  Image fits = lattice_of(y);
  parallel_for(static_cast<std::size_t>(fits.height()), progress, [&](std::size_t row) {
    Scratch scratch;
    std::vector<Real> variance(static_cast<std::size_t>(y.channels()));
    const int v = static_cast<int>(row);
    for (int x = 0; x < fits.width(); ++x) {
      fit_noise(y, features, picture, x * lattice_stride, v * lattice_stride, scratch, variance.data());
      for (int c = 0; c < y.channels(); ++c) fits.at(x, v, c) = variance[static_cast<std::size_t>(c)];
    }
  });
  fits = medians_around(fits);
  Image out = spike_variance(y);
  const Image edges = samples.empty() ? Image() : edge_variance(y, samples, picture);
  parallel_for(static_cast<std::size_t>(out.height()), progress, [&](std::size_t row) {
    const int v = static_cast<int>(row);
    for (int c = 0; c < y.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const Real value = y.at(x, v, c), fit = fits.at(x / lattice_stride, v / lattice_stride, c);
        const Real noise = std::max({fit, out.at(x, v, c), edges.empty() ? Real(0) : edges.at(x, v, c)});
        out.at(x, v, c) = value == 0 ? Real(0) : beyond_rounding(noise, value);
      }
  });
  return out;
}

NoiseVariance noise_variance(const Frame& frame, Progress& progress, const Image& picture) {
  if (!frame.beauty.variance.empty()) return {frame.beauty.variance, "from the file", true};
  if (frame.beauty.has_halves()) return {variance_from_halves(frame.beauty, picture), "from the half buffers", true};
  Image y = frame.beauty.mean;
  repair_nonfinite(y, 2);
  return {estimate_variance(y, explaining_features(frame, picture), progress, picture, frame.sample_count),
          "estimated from the image", false};
}

void estimate_feature_variance(Frame& frame, Progress& progress, const Image& picture) {
  for (Feature& feature : frame.features) {
    if (!noise_is_estimated(feature.role, feature.pass.noise_is_known())) continue;
    Image mean = feature.pass.mean;
    repair_nonfinite(mean, 2);
    feature.pass.variance = estimate_variance(mean, Image(mean.width(), mean.height(), 0), progress, picture);
    feature.pass.variance_is_estimated = true;
  }
}

}  // namespace polyrecon
