#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/half_pair.h"
#include "features/prefilter.h"
#include "polyrecon/frame.h"
#include "polyrecon/progress.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// A feature pass that takes part in the fit.
struct FeatureUse {
  std::size_t index = 0;   ///< Into Frame::features.
  bool prefilter = false;  ///< It is noisy: prefilter it (features/prefilter.h).
  double scale = 1;        ///< Factor that brings its values, but for spikes, to order 1.
  double half_depth = 0;  ///< Depth z enters as z / (z + half_depth): bounded, so that a sky at 1e10 fits; 0: as it is.
};

/// What a look at the whole frame settles before any work: only the steps that the scene calls for are run.
struct Preparation {
  std::vector<FeatureUse> features;
  double epsilon = 1;        ///< HalfPair::epsilon: (0.3 x mean brightness)^2, so that exposure does not matter.
  std::uint64_t stream = 0;  ///< Random numbers of the first of up to 64 splits; frames that meet need different ones.
  std::vector<Decision> decisions;
};

/// Drops features that are absent, not finite, constant, nothing but noise, or more than a model holds, and says which
/// of the others need cleaning. Throws Error{CheckFailed} where the beauty holds no usable pixel.
/// steps: what may run. Without steps.decide every pass that has a finite value takes part and is cleaned.
Preparation look_at(const Frame& frame, const Steps& steps = {});

/// Throws Error{CheckFailed} where the beauty holds no usable pixel.
void require_usable(const Frame& frame);

struct Prepared {
  HalfPair pair;
  bool independent_halves = true;   ///< False where the halves were split from one image.
  std::size_t repaired_pixels = 0;  ///< Non-finite pixels replaced, over all passes used.
  std::size_t negative_pixels = 0;  ///< Beauty pixels with a negative channel; kept as they are.
};

/// Channels that prepare holds for the feature pass in work in addition to the frame and the pair: its two halves, the
/// same prefiltered, and its widened noise variance.
constexpr std::size_t feature_in_preparation_channels = std::size_t{3} * (2 + 2 + 1);

/// Repairs, splits where the file holds no halves (noise/fission.h), transforms and cleans the features.
/// variance: noise variance of the beauty's mean, 3 channels (noise/variance.h). Takes the halves and variances of
/// the frame's passes and all of its features, and gives their memory back as it goes; the other means stay.
Prepared prepare(Frame& frame, const Preparation& preparation, const Image& variance,
                 const PrefilterParams& prefilter_params, bool with_alpha, Progress& progress);

}  // namespace polyrecon
