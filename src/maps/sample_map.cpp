#include "polyrecon/sample_map.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/cancel_only.h"
#include "core/parallel.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// One value per pixel, in double because the water level is a ratio of sums over millions of pixels.
struct Plane {
  int width = 0, height = 0;
  std::vector<double> v;

  Plane(int w, int h) : width(w), height(h), v(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  double* row(int y) { return v.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
  const double* row(int y) const { return v.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
};

void each_row(int height, Progress& progress, const std::function<void(int)>& body) {
  CancelOnly cancel_only(progress);
  parallel_for(static_cast<std::size_t>(height), cancel_only, [&](std::size_t y) { body(static_cast<int>(y)); });
}

/// Sum of term(pixel index) over the plane; has the same bits for any number of threads.
template <typename Term>
double sum_pixels(const Plane& p, Term term) {
  return ordered_sum(static_cast<std::size_t>(p.height), [&](std::size_t y) {
    const std::size_t begin = y * static_cast<std::size_t>(p.width);
    double sum = 0;
    for (std::size_t i = begin; i < begin + static_cast<std::size_t>(p.width); ++i) sum += term(i);
    return sum;
  });
}

std::vector<double> gaussian(int radius) {
  std::vector<double> k(2 * static_cast<std::size_t>(radius) + 1, 1.0);
  const double sigma = radius / 2.0;
  for (int d = -radius; d <= radius && radius > 0; ++d)
    k[static_cast<std::size_t>(d + radius)] = std::exp(-d * d / (2 * sigma * sigma));
  return k;
}

/// Separable convolution with k; values outside the image are zero.
Plane convolve(const Plane& in, const std::vector<double>& k, Progress& progress) {
  const int radius = static_cast<int>(k.size() / 2), w = in.width, h = in.height;
  Plane across(w, h), out(w, h);
  each_row(h, progress, [&](int y) {
    const double* source = in.row(y);
    double* target = across.row(y);
    for (int x = 0; x < w; ++x)
      for (int d = std::max(-radius, -x); d <= std::min(radius, w - 1 - x); ++d)
        target[x] += k[static_cast<std::size_t>(d + radius)] * source[x + d];
  });
  each_row(h, progress, [&](int y) {
    double* target = out.row(y);
    for (int d = std::max(-radius, -y); d <= std::min(radius, h - 1 - y); ++d) {
      const double* source = across.row(y + d);
      for (int x = 0; x < w; ++x) target[x] += k[static_cast<std::size_t>(d + radius)] * source[x];
    }
  });
  return out;
}

/// The Gaussian window K_ij around pixel j, normalised over the pixels i inside the image.
class Window {
 public:
  Window(int width, int height, int radius, Progress& progress)
      : kernel_(gaussian(radius)), weight_(ones(width, height, progress)) {}

  /// sum_i K_ij in_i for every j: the mean over the window of j.
  Plane mean(const Plane& in, Progress& progress) const {
    Plane out = convolve(in, kernel_, progress);
    for (std::size_t i = 0; i < out.v.size(); ++i) out.v[i] /= weight_.v[i];
    return out;
  }
  /// sum_j K_ij in_j for every i: each j distributes its value over its window, so the total is kept.
  Plane spread(const Plane& in, Progress& progress) const {
    Plane shares = in;
    for (std::size_t j = 0; j < shares.v.size(); ++j) shares.v[j] /= weight_.v[j];
    return convolve(shares, kernel_, progress);
  }

 private:
  Plane ones(int width, int height, Progress& progress) const {
    Plane p(width, height);
    std::fill(p.v.begin(), p.v.end(), 1.0);
    return convolve(p, kernel_, progress);
  }

  std::vector<double> kernel_;
  Plane weight_;
};

/// The parts of the error map that the sample map uses; every value is finite and not negative.
struct ErrorParts {
  Plane variance, noise;
  double relative_mse = 0;  ///< Mean over the pixels with a finite error.
  std::size_t unknown = 0;  ///< Pixels without one.
};

ErrorParts split_error(const ErrorMap& error) {
  const Image& mse = error.relative_mse;
  const Image& variance = error.relative_variance;
  const Plane zeros(mse.width(), mse.height());
  ErrorParts parts{zeros, zeros};
  const std::size_t count = mse.pixels();
  std::vector<std::size_t> unknown;
  double variance_sum = 0, mse_sum = 0, noise_sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double m = mse.plane(0)[i], v = variance.plane(0)[i];
    if (!std::isfinite(m) || !std::isfinite(v)) {
      unknown.push_back(i);
      continue;
    }
    parts.variance.v[i] = std::max(v, 0.0);
    if (!error.relative_noise.empty())
      if (const double u = error.relative_noise.plane(0)[i]; std::isfinite(u)) parts.noise.v[i] = std::max(u, 0.0);
    noise_sum += parts.noise.v[i];
    variance_sum += parts.variance.v[i];
    mse_sum += std::max(m, parts.variance.v[i]);
  }
  const auto known = static_cast<double>(count - unknown.size());
  for (const std::size_t i : unknown) {
    parts.variance.v[i] = known > 0 ? variance_sum / known : 1.0;
    parts.noise.v[i] = known > 0 ? noise_sum / known : 0.0;
  }
  parts.relative_mse = known > 0 ? mse_sum / known : 1.0;
  parts.unknown = unknown.size();
  return parts;
}

Plane counts_or(const Image& sample_count, double assumed, int width, int height) {
  Plane n(width, height);
  for (std::size_t i = 0; i < n.v.size(); ++i) {
    const double count = sample_count.empty() ? assumed : static_cast<double>(sample_count.plane(0)[i]);
    n.v[i] = std::isfinite(count) && count > 0 ? count : 1.0;
  }
  return n;
}

/// Cost per sample with mean 1, averaged over the window since the times that renderers measure are noisy per pixel.
Plane relative_cost(const Image& cost, const Window& window, int width, int height, Progress& progress) {
  Plane c(width, height);
  std::fill(c.v.begin(), c.v.end(), 1.0);
  if (cost.empty()) return c;
  const auto usable = [](double value) { return std::isfinite(value) && value > 0; };
  double sum = 0, known = 0;
  for (std::size_t i = 0; i < c.v.size(); ++i)
    if (const double value = cost.plane(0)[i]; usable(value)) sum += value, known += 1;
  if (known == 0) return c;
  for (std::size_t i = 0; i < c.v.size(); ++i)
    if (const double value = cost.plane(0)[i]; usable(value)) c.v[i] = value * known / sum;
  c = window.mean(c, progress);
  const double mean = sum_pixels(c, [&](std::size_t i) { return c.v[i]; }) / static_cast<double>(c.v.size());
  for (double& value : c.v) value /= mean;
  return c;
}

/// The water-filling as a function of the level t = 1 / sqrt(lambda): dn_i = clamp(s_i t - n_i, 0, cap).
struct Filling {
  Plane s;  ///< sqrt(V_i n_i / c_i)
  Plane n, c, V;
  double cap = 0;

  double extra(std::size_t i, double t) const { return std::min(std::max(s.v[i] * t - n.v[i], 0.0), cap); }
  double spent(double t) const {
    return sum_pixels(s, [&](std::size_t i) { return c.v[i] * extra(i, t); });
  }
  /// The part of the error that is left at level t; 1 if no sample reduces it.
  double left(double t) const {
    const double all = sum_pixels(s, [&](std::size_t i) { return V.v[i]; });
    if (!(all > 0)) return 1;
    return sum_pixels(
               s, [&](std::size_t i) { return V.v[i] * std::pow(n.v[i] / (n.v[i] + extra(i, t)), convergence_rate); }) /
           all;
  }
};

/// Levels between which the filling changes: below lo no pixel gets samples, above hi no pixel gets more. lo > hi if no
/// pixel ever gets samples.
struct Levels {
  double lo = std::numeric_limits<double>::infinity(), hi = 0;
};

Levels range_of(const Filling& f) {
  Levels r;
  for (std::size_t i = 0; i < f.s.v.size(); ++i)
    if (f.s.v[i] > 0) {
      r.lo = std::min(r.lo, f.n.v[i] / f.s.v[i]);
      r.hi = std::max(r.hi, (f.n.v[i] + f.cap) / f.s.v[i]);
    }
  return r;
}

/// The lowest level in the range, to double precision, at which reached(t) holds; reached is monotone and holds at hi.
template <typename Reached>
double lowest_level(Levels r, Reached reached, Progress& progress) {
  constexpr double tolerance = 4 * std::numeric_limits<double>::epsilon();
  while (r.hi - r.lo > tolerance * r.hi) {
    if (progress.cancelled()) throw Error(ExitCode::Interrupted, "interrupted");
    // Bisects the exponent, as the levels of bright and dark pixels can differ by tens of powers of ten.
    double middle = std::sqrt(r.lo) * std::sqrt(r.hi);
    if (middle <= r.lo || middle >= r.hi) middle = r.lo + (r.hi - r.lo) / 2;
    if (middle <= r.lo || middle >= r.hi) break;
    (reached(middle) ? r.hi : r.lo) = middle;
  }
  return r.hi;
}

/// V_i of make_sample_map, up to a common factor.
Plane error_of_noise(const ErrorParts& parts, const Window& window, Progress& progress) {
  Plane V = window.spread(parts.variance, progress);
  Plane both = window.spread(parts.noise, progress);
  for (std::size_t i = 0; i < both.v.size(); ++i) both.v[i] = std::sqrt(both.v[i]) * std::sqrt(V.v[i]);
  // V is that of the variance alone if the noise is unknown, or zero although there is an error.
  return sum_pixels(both, [&](std::size_t i) { return both.v[i]; }) > 0 ? both : V;
}

void check_shapes(const ErrorMap& error, const Image& sample_count, const Image& cost) {
  const Image& mse = error.relative_mse;
  if (mse.empty() || mse.channels() != 1 || !mse.same_shape(error.relative_variance))
    throw Error(ExitCode::BadInput, "the error map needs a relative MSE and a relative variance of one size");
  if (!error.relative_noise.empty() && !error.relative_noise.same_shape(mse))
    throw Error(ExitCode::BadInput, "the noise has another size than the error map");
  if (!sample_count.empty() && !sample_count.same_shape(mse))
    throw Error(ExitCode::BadInput, "the sample counts have another size than the error map");
  if (!cost.empty() && !cost.same_shape(mse))
    throw Error(ExitCode::BadInput, "the cost image has another size than the error map");
}

/// Fills samples, importance, total, min and max of the map from the filling at level t.
void store(const Filling& f, double t, SampleMap& map) {
  Real* samples = map.samples.plane(0);
  Real* importance = map.importance.plane(0);
  const std::size_t count = map.samples.pixels();
  for (std::size_t i = 0; i < count; ++i) samples[i] = static_cast<Real>(f.extra(i, t));
  map.min = *std::min_element(samples, samples + count);
  map.max = *std::max_element(samples, samples + count);
  map.total = sum_pixels(f.s, [&](std::size_t i) { return static_cast<double>(samples[i]); });
  if (map.max > 0)
    for (std::size_t i = 0; i < count; ++i) importance[i] = static_cast<Real>(samples[i] / map.max);
}

}  // namespace

void validate(const SampleMapParams& params) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (positive(params.budget) == positive(params.target) || params.budget < 0 || params.target < 0)
    throw Error(ExitCode::Usage, "a sample map needs either a positive budget or a positive target");
  if (!positive(params.max_samples)) throw Error(ExitCode::Usage, "the most samples of a pixel must be positive");
  if (params.budget > params.max_samples)
    throw Error(ExitCode::Usage, "the budget must not be above the most samples of a pixel");
  if (!positive(params.assumed_samples)) throw Error(ExitCode::Usage, "the samples already taken must be positive");
  if (params.radius < 0 || params.radius > 64) throw Error(ExitCode::Usage, "the window radius must be 0 to 64");
}

SampleMap make_sample_map(const ErrorMap& error, const Image& sample_count, const Image& cost,
                          const SampleMapParams& params, Progress& progress) {
  validate(params);
  check_shapes(error, sample_count, cost);
  const int width = error.relative_mse.width(), height = error.relative_mse.height();
  const auto pixels = static_cast<double>(error.relative_mse.pixels());
  SampleMap map;
  map.samples = map.importance = Image(width, height, 1);

  const ErrorParts parts = split_error(error);
  map.unknown_pixels = parts.unknown;
  if (params.target > 0 && parts.unknown == error.relative_mse.pixels())
    throw Error(ExitCode::BadInput, "no pixel of the error map is finite: a target cannot be checked, give a budget");

  const Window window(width, height, params.radius, progress);
  Filling f{Plane(width, height), counts_or(sample_count, params.assumed_samples, width, height),
            relative_cost(cost, window, width, height, progress), error_of_noise(parts, window, progress),
            params.max_samples};
  for (std::size_t i = 0; i < f.s.v.size(); ++i) f.s.v[i] = std::sqrt(f.V.v[i] * f.n.v[i] / f.c.v[i]);

  map.error_before = parts.relative_mse;
  const Levels levels = range_of(f);
  const auto enough = [&](double t) {
    return params.budget > 0 ? f.spent(t) >= params.budget * pixels : map.error_before * f.left(t) <= params.target;
  };
  double t = 0;
  if (levels.hi > 0 && !enough(0)) t = enough(levels.hi) ? lowest_level(levels, enough, progress) : levels.hi;
  map.limit_met = enough(t);
  map.error_after = map.error_before * f.left(t);
  store(f, t, map);
  return map;
}

}  // namespace polyrecon
