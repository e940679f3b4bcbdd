#include "pipeline/memory.h"

#include <algorithm>

#include "blend/noise_bound.h"
#include "core/candidate.h"
#include "core/color_layout.h"
#include "core/frame_shape.h"
#include "core/wrap.h"
#include "denoisers/denoise_frame.h"
#include "denoisers/denoisers.h"
#include "features/prepare.h"
#include "maps/error_map_images.h"
#include "noise/variance.h"
#include "outliers/restore.h"
#include "pipeline/stage.h"
#include "pipeline/use_prior.h"
#include "polyrecon/error.h"
#include "prior/mix.h"
#include "prior/prior_candidate.h"
#include "regression/basis.h"
#include "temporal/neighbour.h"

namespace polyrecon {
namespace {

constexpr double allocator = 1.08;  // unused memory between images of unequal sizes; tests/bench/scaling.py: up to 6 %

constexpr std::size_t primaries = ColorLayout::primaries;
constexpr std::size_t validation_halves_channels = 2 * primaries;  // our halves next to those of a prior

std::size_t count(int channels) { return static_cast<std::size_t>(channels); }

int model_features(const FrameShape& shape) { return std::min(shape.feature_channels, BasisLayout::max_features); }

/// Colour channels of the pair: alpha is one where it is reconstructed.
int reconstructed_channels(const FrameShape& shape, const Params& params) {
  return shape.color_channels + (params.reconstruct_alpha ? 1 : 0);
}

std::size_t pair_channels(const FrameShape& shape) {
  return half_pair_channels(count(shape.color_channels), count(model_features(shape)));
}

/// Channels held to the end of a reconstruction: images of the frame and the noise variance of the beauty.
std::size_t kept_channels(const FrameShape& shape) {
  constexpr std::size_t alpha = 1, sample_count = 1;
  const std::size_t prior = count(shape.prior_channels) + (shape.prior_has_halves ? validation_halves_channels : 0);
  return count(shape.color_channels) + alpha + sample_count + prior + noise_variance_channels +
         count(shape.other_channels);
}

/// Channels held while windows are fitted: the pair and the results of this stage and the one before, each with its
/// coarser levels, which have 1/4 + 1/16 + ... < 1/3 of the pixels.
std::size_t fitting_channels(const FrameShape& shape) {
  return (pair_channels(shape) + 2 * candidate_channels(count(shape.color_channels))) * 4 / 3;
}

/// Channels held after the fits: the pair, the result with its error and order maps, and what the prior or the return
/// of energy works with.
std::size_t finishing_channels(const FrameShape& shape) {
  const std::size_t colors = count(shape.color_channels);
  constexpr std::size_t order_map = 1;
  const std::size_t layers_without_prior = colors > primaries ? colors : 0;
  const std::size_t using_prior = std::max(prior_candidate_channels, share_channels);
  const std::size_t prior = shape.prior_channels > 0 ? using_prior + layers_without_prior : 0;
  return pair_channels(shape) + candidate_channels(colors) + error_map_channels(shape.prior_channels > 0) + order_map +
         std::max(prior, restore_channels(colors));
}

}  // namespace

FrameShape shape_of(const Frame& frame) {
  FrameShape shape{frame.beauty.mean.pixels(), frame.motion.channels()};
  shape.wrapped_rows = frame.wraps ? frame.height() : 0;
  const auto add = [&](Role role, const Pass& pass) {
    for (const Image* image : {&pass.mean, &pass.variance, &pass.half_a, &pass.half_b})
      shape.channels += image->channels();
    if (!pass.mean.empty()) add_pass(shape, role, {!pass.variance.empty(), pass.has_halves()});
  };
  add(Role::Beauty, frame.beauty);
  add(Role::Prior, frame.prior);
  for (const Pass& aov : frame.aovs) add(Role::Color, aov);
  for (const Feature& feature : frame.features) add(feature.role, feature.pass);
  return shape;
}

void add_denoiser(FrameShape& shape) {
  shape.runs_denoiser = true;
  shape.prior_channels = 0;
  add_pass(shape, Role::Prior, {false, true});
  shape.channels += shape.prior_channels + static_cast<int>(denoiser_features_channels);
}

int neighbours_channels(const FrameShape& shape, int neighbours, const Params& params) {
  // The geometry of the frame itself and its noise are held until the neighbours have joined.
  const std::size_t own = neighbours > 0 ? geometry_channels() + surfaces : 0;
  return static_cast<int>(
      static_cast<std::size_t>(neighbours) * neighbour_channels(count(reconstructed_channels(shape, params))) + own);
}

int channels_ahead(const FrameShape& shape, const Params& params) {
  return shape.channels + (params.temporal.radius > 0 ? neighbours_channels(shape, 2, params) : 0);
}

MemoryNeeds memory_needs(const FrameShape& passes, const Params& params) {
  FrameShape shape = passes;
  shape.pixels += static_cast<std::size_t>(shape.wrapped_rows) * 2 * wrap_margin;
  shape.color_channels = reconstructed_channels(passes, params);
  const auto with_gaps = [](std::size_t bytes) {
    return static_cast<std::size_t>(allocator * static_cast<double>(bytes));
  };
  const auto image_bytes = [&](std::size_t channels) { return shape.pixels * channels * sizeof(Real); };
  const std::size_t preparing = count(shape.channels + shape.other_channels) + noise_variance_channels +
                                pair_channels(shape) + feature_in_preparation_channels;
  const std::size_t denoising = kept_channels(shape) + pair_channels(shape) + denoiser_features_channels;
  const std::size_t validating =
      shape.prior_has_halves ? pair_channels(shape) + validation_channels(count(model_features(shape))) : 0;
  const std::size_t holding =
      kept_channels(shape) + std::max({fitting_channels(shape), validating, finishing_channels(shape)});
  MemoryNeeds needs;
  needs.prepare = with_gaps(program_bytes + image_bytes(preparing));
  if (shape.runs_denoiser)
    needs.denoiser =
        with_gaps(program_bytes + image_bytes(denoising + denoise_frame_channels + denoiser_run_channels)) +
        least_denoiser_bytes;
  needs.held = with_gaps(program_bytes + image_bytes(holding));
  needs.tile = with_gaps(std::min(smallest_tile_pixels(params), shape.pixels) *
                         stage_bytes_per_pixel(shape.color_channels, model_features(shape), params));
  return needs;
}

void require_memory(const std::string& name, const FrameShape& shape, const Params& params) {
  const std::size_t least = memory_needs(shape, params).least();
  if (params.max_memory >= least) return;
  throw Error(ExitCode::OutOfMemory, name + ": " + std::to_string(shape.pixels) + " pixels with " +
                                         std::to_string(shape.channels) + " channels in use needs --max-memory " +
                                         std::to_string((least >> 20) + 1) + "M, or fewer passes");
}

std::size_t denoiser_memory(const FrameShape& shape, const Params& params) {
  const std::size_t others = memory_needs(shape, params).denoiser - least_denoiser_bytes;
  return params.max_memory > others ? params.max_memory - others : 0;
}

std::size_t tile_memory(const FrameShape& shape, const Params& params) {
  const std::size_t held = memory_needs(shape, params).held;
  return held < params.max_memory ? static_cast<std::size_t>(static_cast<double>(params.max_memory - held) / allocator)
                                  : 0;
}

}  // namespace polyrecon
