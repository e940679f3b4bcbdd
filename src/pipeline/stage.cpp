#include "pipeline/stage.h"

#include <algorithm>
#include <utility>

#include "blend/blend_windows.h"
#include "blend/select.h"
#include "core/gaussian.h"
#include "core/halves.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/relmse.h"
#include "core/tiles.h"

namespace polyrecon {
namespace {

constexpr double residual_sigma = 1;  // pixels; Gaussian that averages the squared difference of a stage's halves

/// Whether the noise of some channel of the beauty is above Params::enough.
bool noise_matters(const HalfPair& pair, std::size_t i, Real enough) {
  for (int c = 0; c < 3; ++c) {
    const Real mean = Real(0.5) * (pair.color[0].plane(c)[i] + pair.color[1].plane(c)[i]);
    if (Real(0.5) * pair.variance.plane(c)[i] > enough * relmse_denominator(mean)) return true;
  }
  return false;
}

/// Marks the samples that have noise and so are fitted. A pixel has none if its halves are equal and its variance is 0,
/// or if its noise bound is 0, which no fit keeps within.
std::vector<unsigned char> noisy_pixels(const HalfPair& pair, const Params& params) {
  std::vector<unsigned char> noisy(pair.variance.pixels(), params.steps.decide ? 0 : 1);
  for (int c = 0; c < pair.color[0].channels(); ++c) {
    const Real *a = pair.color[0].plane(c), *b = pair.color[1].plane(c), *v = c < 3 ? pair.variance.plane(c) : nullptr;
    for (std::size_t i = 0; i < noisy.size(); ++i)
      if (a[i] != b[i] || (v && v[i] > 0)) noisy[i] = 1;
  }
  if (!pair.bound.empty() && params.steps.decide)
    for (std::size_t i = 0; i < noisy.size(); ++i) noisy[i] = noisy[i] && pair.bound.plane(0)[i] > 0;
  if (!pair.sampled.empty())
    for (std::size_t i = 0; i < noisy.size(); ++i) noisy[i] = noisy[i] && in_mask(pair.sampled, i);
  if (params.enough > 0)
    for (std::size_t i = 0; i < noisy.size(); ++i)
      noisy[i] = noisy[i] && noise_matters(pair, i, static_cast<Real>(params.enough));
  return noisy;
}

/// Colours in which patches are compared for the weights of a window.
struct Guide {
  std::array<const Image*, 2> color;  ///< color[h] is for the fit of half h.
  const Image* variance;              ///< Noise variance of the colours, or residual_variance, which is larger.
};

/// Adds a candidate for every bandwidth. With cross_filter, half h is fitted with the features and the guess of the
/// other half.
void add_candidates(const HalfPair& pair, const Guide& guide, const Candidate* before,
                    const std::vector<unsigned char>& noisy, const FitParams& fit, bool cross_filter,
                    FitCounters& counters, Progress& progress, std::vector<Candidate>& candidates) {
  if (fit.bandwidths.empty()) return;
  std::array<std::vector<BlendedFit>, 2> fits;
  for (std::size_t h = 0; h < 2; ++h) {
    const std::size_t other = cross_filter ? 1 - h : h;
    const FitSource source{&pair.color[h], &pair.variance, &pair.features[other],
                           guide.color[h], guide.variance, before ? &before->half[other] : nullptr,
                           pair.epsilon,   &pair.sampled,  &pair.color[other],
                           &pair.bound};
    fits[h] = fit_and_blend(source, noisy, fit, counters, progress);
  }
  const auto mean = [](Image a, const Image& b) {
    for (int c = 0; c < a.channels(); ++c) {
      Real* p = a.plane(c);
      const Real* q = b.plane(c);
      for (std::size_t i = 0; i < a.pixels(); ++i) p[i] = Real(0.5) * (p[i] + q[i]);
    }
    return a;
  };
  for (std::size_t k = 0; k < fit.bandwidths.size(); ++k)
    candidates.push_back({{std::move(fits[0][k].value), std::move(fits[1][k].value)},
                          mean(std::move(fits[0][k].squared_bias), fits[1][k].squared_bias),
                          mean(std::move(fits[0][k].variance), fits[1][k].variance),
                          mean(std::move(fits[0][k].order), fits[1][k].order)});
}

/// The noisy halves as a candidate without bias, which a pixel keeps where no fit is better.
Candidate unfitted(const HalfPair& pair) {
  Image noise = pair.variance;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < noise.pixels(); ++i)
      noise.plane(c)[i] *= Real(0.5);  // the variance of the mean of the halves
  return {{pair.color[0], pair.color[1]},
          Image(pair.width(), pair.height(), 3),
          std::move(noise),
          Image(pair.width(), pair.height(), 1)};
}

/// Squared difference of the halves of a stage's result, blurred: on average twice the noise variance of a half, and
/// four times that of their mean.
Image residual_variance(const Candidate& candidate, const Image& mask) {
  Image out(candidate.half[0].width(), candidate.half[0].height(), 3);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i) {
      const Real difference = candidate.half[0].plane(c)[i] - candidate.half[1].plane(c)[i];
      out.plane(c)[i] = difference * difference;
    }
  return gaussian_blur(out, residual_sigma, mask);
}

Candidate stage_of_tile(const HalfPair& pair, const Candidate* before, const Params& params, FitCounters& counters,
                        Progress& progress) {
  const auto noisy = noisy_pixels(pair, params);
  std::vector<Candidate> candidates;
  const bool cross_filter = params.components.cross_filter;
  const std::size_t guides_a = cross_filter ? 1 : 0;
  const Guide raw{{&pair.color[guides_a], &pair.color[1 - guides_a]}, &pair.variance};
  const FitParams raw_fit = before ? fit_params(params, params.later_bandwidths) : first_fit_params(params);
  add_candidates(pair, raw, before, noisy, raw_fit, cross_filter, counters, progress, candidates);
  Image brightness;
  if (before) {
    brightness = mean_of_halves(before->half, 3);
    const Image variance = residual_variance(*before, pair.sampled);
    const Guide guided{{&brightness, &brightness}, &variance};
    add_candidates(pair, guided, before, noisy, fit_params(params, params.guided_bandwidths), cross_filter, counters,
                   progress, candidates);
  } else {
    brightness = mean_of_halves(candidates.back().half, 3);
  }
  candidates.push_back(unfitted(pair));
  return select(pair, brightness, candidates, params.selection);
}

}  // namespace

FitParams fit_params(const Params& params, const std::vector<Real>& bandwidths) {
  return {params.radius,    params.stride,          params.patch,    bandwidths,
          params.max_order, params.order_tolerance, params.coverage, params.components.shrinkage};
}

FitParams first_fit_params(const Params& params) {
  FitParams fit = fit_params(params, params.first_bandwidths);
  if (params.stages > 1) {
    fit.stride = std::min(params.stride + params.stride / 2, params.radius);
    fit.coverage = params.coverage / 4;
  }
  return fit;
}

double skipped_share(const HalfPair& pair, const Params& params) {
  const auto noisy = noisy_pixels(pair, params);
  const auto left = std::count(noisy.begin(), noisy.end(), 0);
  return static_cast<double>(left) / static_cast<double>(noisy.size());
}

int stage_halo(const Params& params) {
  // Halo = radius of the blur of residual_variance + fit_halo + select_halo.
  const int fits = std::max(fit_halo(first_fit_params(params)), fit_halo(fit_params(params, params.later_bandwidths)));
  return gaussian_radius(residual_sigma) + fits + select_halo(params.selection);
}

std::size_t smallest_tile_pixels(const Params& params) {
  const int margin = (stage_halo(params) + 2 * block_size - 1) / (2 * block_size) * 2 * block_size;
  const auto side = static_cast<std::size_t>(2 * block_size + 2 * margin);
  return side * side;
}

std::size_t stage_bytes_per_pixel(int color_channels, int feature_channels, const Params& params) {
  const auto colors = static_cast<std::size_t>(color_channels);
  const std::size_t raw = std::max(params.first_bandwidths.size(), params.later_bandwidths.size());
  const std::size_t guided = params.guided_bandwidths.size(), candidates = raw + guided + 1;
  constexpr std::size_t brightness = 3, guide_variance = 3, noisy_mask_bytes = 1;
  const std::size_t candidate = candidate_channels(colors);
  const std::size_t inputs = half_pair_channels(colors, static_cast<std::size_t>(feature_channels)) + candidate;
  // Per bandwidth: the fits of both halves and, while the second is made, its sums.
  const std::size_t fits = 2 * blended_fit_channels(colors) + blend_sums_channels(colors);
  const std::size_t fitting_raw = raw * fits;
  const std::size_t fitting_guided = raw * candidate + brightness + guide_variance + guided * fits;
  const std::size_t selecting = candidates * candidate + brightness + select_channels(candidates, colors);
  const std::size_t work = std::max({fitting_raw, fitting_guided, selecting});
  return sizeof(Real) * (inputs + work) + noisy_mask_bytes + blend_mask_bytes;
}

Candidate run_stage(const HalfPair& pair, const Candidate* before, const Params& params, std::size_t max_bytes,
                    FitCounters& counters, Progress& progress) {
  const int halo = stage_halo(params);
  const auto tiles =
      make_tiles({0, 0, pair.width(), pair.height()}, halo, 2 * block_size,
                 max_bytes / stage_bytes_per_pixel(pair.color[0].channels(), pair.features[0].channels(), params));
  if (tiles.size() == 1) return stage_of_tile(pair, before, params, counters, progress);
  Candidate whole = make_candidate(pair.width(), pair.height(), pair.color[0].channels());
  for (const Tile& tile : tiles) {
    const HalfPair part = crop(pair, tile.padded);
    const Candidate before_part = before ? crop(*before, tile.padded) : Candidate{};
    const Candidate result = stage_of_tile(part, before ? &before_part : nullptr, params, counters, progress);
    paste(result, inside(tile), whole, tile.core.x0, tile.core.y0);
  }
  return whole;
}

}  // namespace polyrecon
