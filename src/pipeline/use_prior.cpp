#include "pipeline/use_prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "core/color_layout.h"
#include "core/halves.h"
#include "core/mean.h"
#include "core/parallel.h"
#include "core/repair.h"
#include "denoisers/denoise_frame.h"
#include "maps/error_map.h"
#include "noise/fission.h"
#include "noise/half_correlation.h"
#include "pipeline/solve.h"
#include "prior/exposure.h"
#include "prior/prior_candidate.h"

namespace polyrecon {
namespace {

constexpr double most_noise_in_prior = 0.9;  // above it the prior is the input, which would validate itself
// Share of the denoised mean in the picture that is mixed in; the rest is the mean of the denoised halves. Both are
// made of the same samples, but the denoiser sees all of them at once in the mean.
constexpr Real mean_share = Real(2) / 3;
constexpr std::uint64_t validation_stream = std::uint64_t{1} << 40;  // apart from those of frames and their neighbours

Image finite_mean(const Frame& frame, Role role) {
  for (const Feature& feature : frame.features)
    if (feature.role == role) {
      Image mean = feature.pass.mean;
      repair_nonfinite(mean, repair_depth);
      return mean;
    }
  return {};
}

Image beauty_of(const Image& color) { return crop(color, color.bounds(), 0, ColorLayout::primaries); }

Image scaled(Image image, Real factor) {
  for_rows(image.height(), [&](int y) {
    for (int c = 0; c < image.channels(); ++c)
      for (int x = 0; x < image.width(); ++x) image.at(x, y, c) *= factor;
  });
  return image;
}

/// The feature of a role as the fits have it, without its scale. Where it takes no part in them it is `noisy`, which is
/// then constant, or nothing but noise.
Image fitted_feature(const std::vector<FeatureUse>& uses, Role role, const HalfPair& pair, Image noisy) {
  int channel = 0;
  for (const FeatureUse& use : uses) {
    const int channels = info_of(use.role).channels;
    if (use.role == role) {
      const auto part = [&](std::size_t h) {
        return crop(pair.features[h], pair.features[h].bounds(), channel, channels);
      };
      return scaled(mean_of_halves({part(0), part(1)}, channels), static_cast<Real>(1 / use.scale));
    }
    channel += channels;
  }
  return noisy;
}

/// A half as a pair of its own. correlation: of the noise of neighbouring pixels.
HalfPair half_alone(const HalfPair& pair, std::size_t h, double correlation) {
  HalfPair out;
  out.color = split_halves(beauty_of(pair.color[h]), pair.variance, validation_stream + h, correlation);
  out.variance = scaled(pair.variance, Real(2));
  out.features = {pair.features[h], pair.features[h]};
  out.epsilon = pair.epsilon;
  out.sampled = pair.sampled;
  return out;
}

Params validation_params(const Params& params) {
  Params validation = params_for(Quality::Draft);
  validation.stages = std::min(params.stages, 2);
  validation.patch = params.patch;
  return validation;
}

/// The picture that is mixed in.
Image picture_of(const Pass& prior, const ValidationHalves& validation, const HalfPair& pair,
                 const Image& reconstruction) {
  Image mean = in_exposure(prior.mean, pair, reconstruction);
  if (validation.prior[0].empty()) return mean;
  for_rows(mean.height(), [&](int y) {
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < mean.width(); ++x) {
        const Real halves = Real(0.5) * (validation.prior[0].at(x, y, c) + validation.prior[1].at(x, y, c));
        mean.at(x, y, c) = halves + mean_share * (mean.at(x, y, c) - halves);
      }
  });
  return mean;
}

Candidate mix(const ReadyPrior& prior, const HalfPair& pair, const Image& reconstruction, Candidate solved,
              ErrorMap& error, Decision& decision) {
  const Image picture = picture_of(prior.pass, prior.validation, pair, reconstruction);
  const Image share =
      prior.validated ? reconstruction_share(pair, prior.validation) : unvalidated_share(pair, picture, reconstruction);
  lower_error(reconstruction, picture, share, pair.sampled, error);
  decision.reason += fmt::format(", {:.0f} % of the result{}", 100 * (1 - mean_of(share)),
                                 prior.validated ? "" : "; a single render has no halves to validate it");
  return mix_with_prior(std::move(solved), picture, share);
}

}  // namespace

DenoiserFeatures denoiser_features(const Frame& frame) {
  return {finite_mean(frame, Role::Albedo), finite_mean(frame, Role::Normal)};
}

Pass make_prior(const Denoiser& denoiser, DenoiserFeatures features, const std::vector<FeatureUse>& uses,
                const Prepared& prepared, const DenoiserParams& params, std::size_t max_bytes, Progress& progress) {
  const HalfPair& pair = prepared.pair;
  DenoiserInput input{{beauty_of(pair.color[0]), beauty_of(pair.color[1])},
                      prepared.independent_halves,
                      std::move(features),
                      !params.prefilter_features};
  if (input.noise_free_features)
    input.features = {fitted_feature(uses, Role::Albedo, pair, std::move(input.features.albedo)),
                      fitted_feature(uses, Role::Normal, pair, std::move(input.features.normal))};
  return denoise_frame(denoiser, std::move(input), params, max_bytes, progress);
}

std::size_t make_prior_units(const Prepared& prepared, const DenoiserParams& params) {
  return Denoiser::units * denoiser_calls(prepared.independent_halves, !params.prefilter_features, params);
}

ReadyPrior ready_prior(Pass prior, bool made_here, const Prepared& prepared) {
  ReadyPrior out{std::move(prior), made_here, false, false, {}};
  out.validated = out.pass.has_halves() && prepared.independent_halves;
  if (out.validated && !made_here && !made_of_halves(prepared.pair, out.pass.half_a, out.pass.half_b)) {
    out.validated = false;
    out.foreign_halves = true;
  }
  // The mean of a file may be any picture; only the mean of its halves is validated.
  if (out.validated && !made_here)
    out.pass.mean = mean_of_halves({out.pass.half_a, out.pass.half_b}, ColorLayout::primaries);
  return out;
}

ValidationHalves make_validation(Pass& prior, const HalfPair& pair, const Params& params, std::size_t max_bytes,
                                 Progress& progress) {
  ValidationHalves out;
  const double correlation = correlation_of_halves(pair);
  for (std::size_t h = 0; h < 2; ++h) {
    FitCounters not_reported;
    const HalfPair half = half_alone(pair, h, correlation);
    out.ours[h] = mean_of_halves(solve(half, validation_params(params), max_bytes, not_reported, progress).half,
                                 ColorLayout::primaries);
    out.prior[h] = in_exposure(std::move(h == 0 ? prior.half_a : prior.half_b), pair, out.ours[h]);
  }
  return out;
}

std::size_t validation_units(const HalfPair& pair, const Params& params) {
  return 2 * fit_units(pair, validation_params(params));
}

std::size_t validation_channels(std::size_t feature_channels) {
  return (half_pair_channels(ColorLayout::primaries, feature_channels) +
          2 * candidate_channels(ColorLayout::primaries)) *
         4 / 3;
}

Candidate use_prior(ReadyPrior prior, const HalfPair& pair, const Image& reconstruction, const SelectParams& params,
                    std::size_t max_bytes, Candidate solved, ErrorMap& error, std::vector<Decision>& decisions) {
  Decision decision{"prior", true, "prior '" + prior.pass.name + "'"};
  if (prior.made_here || prior.validated) {
    solved = mix(prior, pair, reconstruction, std::move(solved), error, decision);
  } else {
    const CorrectedPrior corrected = correct_prior(std::move(prior.pass), pair, reconstruction);
    decision.run = noise_in_prior(corrected.value, pair, reconstruction) < most_noise_in_prior;
    if (!decision.run) decision.reason += " is the noisy image itself";
    if (prior.foreign_halves) decision.reason += "; its halves are not those of this render and count as none";
    if (decision.run) solved = add_prior(pair, corrected, error.mse, std::move(solved), params, max_bytes);
  }
  decisions.push_back(std::move(decision));
  return solved;
}

}  // namespace polyrecon
