#pragma once

#include <cstddef>

#include "core/half_pair.h"
#include "features/choose_features.h"
#include "features/prefilter.h"
#include "polyrecon/frame.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// The input of the fit.
struct Prepared {
  HalfPair pair;
  bool independent_halves = true;   ///< False if the halves were split from one image.
  std::size_t repaired_pixels = 0;  ///< Number of non-finite pixels that were replaced, over all passes in use.
  std::size_t negative_pixels = 0;  ///< Number of beauty pixels with a negative channel. They are kept.
};

/// Channels that prepare holds for the feature pass in work in addition to the frame and the pair: its two halves, the
/// same prefiltered, its widened noise variance, and the part of its variation that is noise.
constexpr std::size_t feature_in_preparation_channels = std::size_t{3} * (2 + 2 + 1 + 1);

/// Repairs the passes, splits those without halves (noise/fission.h), and transforms and prefilters the features.
/// variance: noise variance of the beauty's mean, 3 channels (noise/variance.h). To save memory, the halves and
/// variances of the frame's passes and all of its features are moved out of the frame; the other means stay.
Prepared prepare(Frame& frame, const Preparation& preparation, const Image& variance,
                 const PrefilterParams& prefilter_params, bool with_alpha, Progress& progress);

}  // namespace polyrecon
