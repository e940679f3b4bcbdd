#include "noise/variance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/gaussian.h"
#include "core/halves.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/real.h"
#include "core/rect.h"
#include "core/repair.h"
#include "noise/edge_variance.h"
#include "noise/estimate_grid.h"
#include "noise/feature_noise.h"
#include "noise/filter_correlation.h"
#include "noise/spike_variance.h"
#include "regression/least_squares.h"

namespace polyrecon {
namespace {

constexpr int fit_radius = 3;
constexpr double texture_correlation = 0.5;   // a in variance.h, for white noise
constexpr int flat_stride = 4;                // pixels between the windows that noise_correlation looks at
constexpr int least_flat_features = 5;        // channels without variation that make a window flat: albedo and normal,
                                              // of which one may vary
constexpr double most_far_correlation = 0.2;  // with residuals two pixels away; texture and shadows have more
constexpr double least_flat_share = 0.03;     // of all windows
constexpr double left_by_plane = 0.85;  // of the correlation, in the residuals of a plane (0.84 to 0.86 for 0.1 to
                                        // 0.5, by the covariance M C M of the residuals)
constexpr Real most_over_fit = 4;       // of a feature's variance by the corner, over that by fits
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

/// The pixels of an area that are in a window: their places in it, row by row; -1 for pixels outside the mask.
struct Places {
  Rect area;
  std::array<int, std::size_t{2 * fit_radius + 1} * std::size_t{2 * fit_radius + 1}> place;
  bool whole = true;  ///< No pixel is outside the mask, so each place is its index.
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
double noise_in(const std::vector<double>& rest, const Places& places, double freedom, double hat, double correlation) {
  double squares = 0, covariance = 0;
  for (const double r : rest) squares += r * r;
  const int pairs = for_neighbours(places, [&](std::size_t i, std::size_t j) { covariance += rest[i] * rest[j]; });
  if (pairs > 0) covariance /= pairs;
  const double of_texture = texture_correlation * (1 + correlation);
  return std::max((squares / freedom - covariance / of_texture) / (1 + (hat - correlation) / of_texture), 0.0);
}

/// Buffers of one thread.
struct Scratch {
  Window window;
  NestedFactor factor;
  std::vector<Real> weight;
  std::vector<double> rest;
};

/// Fits constant, features and plane around a centre.
Places fit_around(const Image& y, const Image& features, const Image& mask, int cx, int cy, Scratch& s) {
  const BasisLayout layout(features.channels(), 1);
  Window& window = s.window;
  window.reserve(fit_radius, layout.columns(), y.channels());
  s.weight.assign(static_cast<std::size_t>(window.stride), Real(0));
  window.count = 0;
  Places places{intersect(grow({cx, cy, cx + 1, cy + 1}, fit_radius), y.bounds()), {}, true};
  auto place = places.place.begin();
  for (int v = places.area.y0; v < places.area.y1; ++v)
    for (int u = places.area.x0; u < places.area.x1; ++u) {
      *place = in_mask(mask, y.index(u, v)) ? window.count : -1;
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
  return places;
}

/// Estimates the variance of the noise per channel from the fit around a centre; -1 where the window has too few pixels
/// for the columns, or its centre is outside the mask.
void fit_noise(const Image& y, const Image& features, const Image& mask, int cx, int cy, double correlation, Scratch& s,
               Real* out) {
  if (!in_mask(mask, y.index(cx, cy))) {
    std::fill_n(out, y.channels(), Real(-1));
    return;
  }
  const Places places = fit_around(y, features, mask, cx, cy, s);
  const double freedom = s.window.count - degrees_of_freedom(s.factor, s.window);
  const double hat = mean_hat_of_neighbours(s.factor, s.window, places);
  for (int c = 0; c < y.channels(); ++c) {
    residuals_of(s.factor, s.window, s.weight, c, s.rest);
    out[c] = freedom > 0.5 ? storable(noise_in(s.rest, places, freedom, hat, correlation)) : Real(-1);
  }
}

/// Mean product of the values of a full window that are `lag` apart along rows and along columns.
double mean_product(const std::vector<double>& values, int lag) {
  constexpr int side = 2 * fit_radius + 1;
  double sum = 0;
  for (int v = 0; v < side; ++v)
    for (int u = 0; u + lag < side; ++u) {
      const auto along = [&](int x, int y) { return values[static_cast<std::size_t>(y * side + x)]; };
      sum += along(u, v) * along(u + lag, v) + along(v, u) * along(v, u + lag);
    }
  return sum / (2 * side * (side - lag));
}

/// Correlation of the residuals with those one and two pixels away around a centre, if the features say that the place
/// is flat and the beauty is noisy there; else nothing.
std::optional<std::array<double, 2>> correlations_if_flat(const Image& y, const Image& features, const Image& mask,
                                                          int cx, int cy, Scratch& s) {
  const Places places = fit_around(y, features, mask, cx, cy, s);
  if (!places.whole || s.window.count < (2 * fit_radius + 1) * (2 * fit_radius + 1) ||
      features.channels() - s.window.layout.features() < least_flat_features)
    return std::nullopt;
  double squares = 0, next = 0, second = 0, rounding = 0;
  for (int c = 0; c < y.channels(); ++c) {
    residuals_of(s.factor, s.window, s.weight, c, s.rest);
    for (const double r : s.rest) squares += r * r / s.window.count;
    next += mean_product(s.rest, 1);
    second += mean_product(s.rest, 2);
    const double value = half_float_rounding * static_cast<double>(y.at(cx, cy, c));
    rounding += value * value;
  }
  if (squares <= rounding) return std::nullopt;
  const double hat = mean_hat_of_neighbours(s.factor, s.window, places);
  return std::array<double, 2>{next / squares + hat, second / squares + hat};
}

Image repaired(const Pass& feature) {
  Image mean = feature.mean;
  repair_nonfinite(mean, 1);
  return mean;
}

/// A feature that explains the beauty, repaired. Where a variation is noise, it would explain the beauty's noise, as
/// the same samples make both.
Image explaining(const Pass& feature, const Image& mask) {
  Image mean = repaired(feature);
  if (!feature.variance_is_estimated) return mean;
  const Image part = noise_in_variation(mean, feature.variance, mask);
  return flattened(std::move(mean), part, mask);
}

/// The features that fit into the local model, in the frame's order, with the values that `values` makes of a pass.
template <typename Values>
Image fitting_features(const Frame& frame, const Values& values) {
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
    const Image mean = values(*feature);
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

Image variance_from_halves(const Pass& beauty, const Image& mask) {
  Image out = beauty.half_a;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i)
      out.plane(c)[i] = variance_of_mean(beauty.half_a.plane(c)[i], beauty.half_b.plane(c)[i]);
  repair_nonfinite(out, 2, largest_variance(beauty.mean));
  return gaussian_blur(out, half_difference_sigma, mask);
}

/// Raises the estimated variance of a feature to what the corner of the spectrum shows, within bounds; see
/// estimate_feature_variance.
void raise_to_corner(const Image& feature, const Image& samples, const Image& mask, Image& variance) {
  const Image corner = corner_variance(feature, mask);
  const Image two_values = samples.empty() ? Image() : two_value_variance(feature, samples);
  for_rows(variance.height(), [&](int y) {
    for (int c = 0; c < variance.channels(); ++c)
      for (int x = 0; x < variance.width(); ++x) {
        Real& fitted = variance.at(x, y, c);
        const Real value = feature.at(x, y, c);
        if (value == 0) continue;
        const Real most = std::max(most_over_fit * fitted, two_values.empty() ? Real(0) : two_values.at(x, y, c));
        fitted = std::max(fitted, beyond_rounding(std::min(corner.at(x, y, c), most), value));
      }
  });
}

/// Whether two pixels are equal in all channels but for rounding to half floats.
bool equal_pixels(const Image& image, int x, int y, int u, int v) {
  for (int c = 0; c < image.channels(); ++c) {
    const Real a = image.at(x, y, c), b = image.at(u, v, c);
    if (std::abs(a - b) > Real(half_float_rounding) * std::max(std::abs(a), std::abs(b))) return false;
  }
  return true;
}

/// Whether a pixel lies in 2 x 2 equal pixels.
bool in_equal_pixels(const Image& image, int x, int y) {
  const auto equal = [&](int u, int v) {
    return u >= 0 && v >= 0 && u < image.width() && v < image.height() && equal_pixels(image, x, y, u, v);
  };
  for (const int dy : {-1, 1})
    if (equal(x, y + dy))
      for (const int dx : {-1, 1})
        if (equal(x + dx, y) && equal(x + dx, y + dy)) return true;
  return false;
}

/// Sets the variance of a feature to 0 where adjacent pixels are equal; see estimate_feature_variance.
void remove_from_equal_pixels(const Image& feature, Image& variance) {
  for_rows(variance.height(), [&](int y) {
    for (int x = 0; x < variance.width(); ++x)
      if (in_equal_pixels(feature, x, y))
        for (int c = 0; c < variance.channels(); ++c) variance.at(x, y, c) = 0;
  });
}

}  // namespace

bool noise_is_measured(const Frame& frame) { return frame.beauty.noise_is_known(); }

double noise_correlation(const Frame& frame, Progress& progress, const Image& mask) {
  Image y = frame.beauty.mean;
  repair_nonfinite(y, 2);
  const Image features = fitting_features(frame, [](const Pass& pass) { return repaired(pass); });
  const int columns = y.width() / flat_stride, rows = y.height() / flat_stride;
  if (features.channels() < least_flat_features || columns * rows == 0) return 0;
  std::vector<std::vector<double>> found(static_cast<std::size_t>(rows));
  parallel_for(found.size(), progress, [&](std::size_t row) {
    Scratch scratch;
    for (int x = 0; x < columns; ++x)
      if (const auto r =
              correlations_if_flat(y, features, mask, x * flat_stride, static_cast<int>(row) * flat_stride, scratch))
        if (std::abs((*r)[1]) < most_far_correlation) found[row].push_back((*r)[0]);
  });
  std::vector<double> all;
  for (const auto& row : found) all.insert(all.end(), row.begin(), row.end());
  if (static_cast<double>(all.size()) < least_flat_share * columns * rows) return 0;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  const double correlation = *middle / left_by_plane;
  return filter_correlation(correlation);
}

Image estimate_variance(const Image& y, const Image& features, Progress& progress, const Image& mask,
                        const Image& samples, double correlation) {
  Image fits = estimate_grid(y);
  parallel_for(static_cast<std::size_t>(fits.height()), progress, [&](std::size_t row) {
    Scratch scratch;
    std::vector<Real> variance(static_cast<std::size_t>(y.channels()));
    const int v = static_cast<int>(row);
    for (int x = 0; x < fits.width(); ++x) {
      fit_noise(y, features, mask, x * grid_stride, v * grid_stride, correlation, scratch, variance.data());
      for (int c = 0; c < y.channels(); ++c) fits.at(x, v, c) = variance[static_cast<std::size_t>(c)];
    }
  });
  fits = medians_around(fits);
  Image out = spike_variance(y);
  const Image edges = samples.empty() ? Image() : edge_variance(y, samples, mask);
  parallel_for(static_cast<std::size_t>(out.height()), progress, [&](std::size_t row) {
    const int v = static_cast<int>(row);
    for (int c = 0; c < y.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const Real value = y.at(x, v, c), fit = fits.at(x / grid_stride, v / grid_stride, c);
        const Real noise = std::max({fit, out.at(x, v, c), edges.empty() ? Real(0) : edges.at(x, v, c)});
        out.at(x, v, c) = value == 0 ? Real(0) : beyond_rounding(noise, value);
      }
  });
  return out;
}

NoiseVariance noise_variance(const Frame& frame, Progress& progress, const Image& mask, double correlation) {
  if (!frame.beauty.variance.empty()) return {frame.beauty.variance, "from the file", true};
  if (frame.beauty.has_halves()) return {variance_from_halves(frame.beauty, mask), "from the half buffers", true};
  Image y = frame.beauty.mean;
  repair_nonfinite(y, 2);
  const Image features = fitting_features(frame, [&](const Pass& pass) { return explaining(pass, mask); });
  return {estimate_variance(y, features, progress, mask, frame.sample_count, correlation), "estimated from the image",
          false};
}

void estimate_feature_variance(Frame& frame, Progress& progress, const Image& mask, double correlation) {
  for (Feature& feature : frame.features) {
    if (!noise_is_estimated(feature.role, feature.pass.noise_is_known())) continue;
    Image mean = feature.pass.mean;
    repair_nonfinite(mean, 2);
    feature.pass.variance =
        estimate_variance(mean, Image(mean.width(), mean.height(), 0), progress, mask, {}, correlation);
    raise_to_corner(mean, frame.sample_count, mask, feature.pass.variance);
    remove_from_equal_pixels(mean, feature.pass.variance);
    feature.pass.variance_is_estimated = true;
  }
}

}  // namespace polyrecon
