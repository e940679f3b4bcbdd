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
  Role role = Role::Normal;
  std::size_t index = 0;   ///< Index into Frame::features.
  bool prefilter = false;  ///< Whether it is prefiltered (features/prefilter.h).
  bool flatten = false;    ///< Whether variations that are noise give way to their blur (noise/feature_noise.h): in
                           ///< renders whose noise is all estimated, where the same samples make all of it.
  double scale = 1;        ///< Factor that brings its values, except spikes, to order 1.
  double half_depth = 0;   ///< If > 0, a depth z enters as z / (z + half_depth), which is below 1 even for the sky.
};

constexpr std::uint64_t streams_per_frame = 64;  ///< Random streams for the splits of a frame's passes.

/// The decisions about a frame before it is reconstructed.
struct Preparation {
  std::vector<FeatureUse> features;
  double epsilon = 1;            ///< HalfPair::epsilon: (0.3 x mean brightness)^2, so that exposure does not matter.
  std::uint64_t stream = 0;      ///< Random stream of the first of streams_per_frame splits, at most. Frames that are
                                 ///< joined need different ones.
  double noise_correlation = 0;  ///< That of the beauty's noise in adjacent pixels (noise/variance.h).
  std::vector<Decision> decisions;
  Image rendered = {};  ///< Mask of the pixels that were rendered; the others stay 0 (core/void_pixels.h).
  Image sampled = {};   ///< Mask of the pixels that are samples of it; the others are hidden.
};

/// Decides which features take part in the fit and which of them are prefiltered. Features that are not finite,
/// constant, or nothing but noise are dropped, and so are those beyond the number of channels that the model holds.
/// Without steps.decide every allowed feature with a finite value takes part and is prefiltered. Throws
/// Error{CheckFailed} if the beauty has no finite pixel. sampled: as Preparation::sampled, which is not set here.
Preparation choose_features(const Frame& frame, const Steps& steps = {}, const Image& sampled = {});

/// Throws Error{CheckFailed} if the beauty has no finite pixel.
void require_usable(const Frame& frame);

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
