#pragma once

#include <array>
#include <cstddef>

#include "core/color_layout.h"
#include "polyrecon/denoiser.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

constexpr std::size_t denoiser_features_channels = std::size_t{2} * ColorLayout::primaries;  ///< Albedo and normal.
/// Channels that denoise_frame holds in addition to its input and its result: a picture and its features, mirrored.
constexpr std::size_t denoise_frame_channels = ColorLayout::primaries + denoiser_features_channels;

/// The input of a denoiser: a frame without values that are not finite.
struct DenoiserInput {
  std::array<Image, 2> halves;       ///< The beauty, 3 channels, linear radiance.
  bool independent_halves = true;    ///< Their noise is independent, so one can validate what is made of the other.
  DenoiserFeatures features;         ///< Features of the mean.
  bool noise_free_features = false;  ///< The features are prefiltered already.
};

/// Denoised halves and mean of a frame, named after the denoiser. A denoiser's errors differ between a picture and the
/// same one mirrored. So the halves are mirrored in two ways, and the mean is the average of params.mean_runs runs in
/// other ways. Without runs for it the mean is that of the halves. Halves that are not independent are not denoised:
/// the mean then takes at least one run, and the pass has no halves.
Pass denoise_frame(const Denoiser& denoiser, DenoiserInput input, const DenoiserParams& params, std::size_t max_bytes,
                   Progress& progress);

/// Calls of the denoiser by denoise_frame, each of Denoiser::units units.
std::size_t denoiser_calls(bool independent_halves, bool noise_free_features, const DenoiserParams& params);

}  // namespace polyrecon
