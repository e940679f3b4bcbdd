#pragma once

#include <array>
#include <cstddef>

#include "polyrecon/denoiser.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// What a denoiser works on: a frame without values that are not finite.
struct DenoiserInput {
  std::array<Image, 2> halves;  ///< The beauty, 3 channels, linear radiance.
  bool independent_halves =
      true;                   ///< Whether their noise is independent, so that one can judge what is made of the other.
  DenoiserFeatures features;  ///< Of the mean.
  bool clean_features = false;  ///< The features have no noise.
};

/// Denoised halves and mean of a frame, named as the denoiser. A denoiser's errors differ between a picture and the
/// same one turned over; so the halves are denoised in two turns and the mean in params.mean_runs others, whose average
/// it is. Without runs for it the mean is that of the halves. Halves that are not independent are not denoised: the
/// mean then takes at least one run, and the pass has no halves.
Pass denoise_frame(const Denoiser& denoiser, DenoiserInput input, const DenoiserParams& params, std::size_t max_bytes,
                   Progress& progress);

/// Calls of the denoiser by denoise_frame, each of Denoiser::units units.
std::size_t denoiser_calls(bool independent_halves, bool clean_features, const DenoiserParams& params);

}  // namespace polyrecon
