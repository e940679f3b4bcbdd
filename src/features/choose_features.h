#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/lamps.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
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

/// Whether values of the feature may be distances of the sky (Frame::sky_depth).
inline bool may_show_sky(const Feature& feature) { return info_of(feature.role).empty == EmptyValue::ZeroOrSky; }

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
  Lamps lamps = {};     ///< They are hidden too, and keep their values.
};

/// Decides which features take part in the fit and which of them are prefiltered. Features that are not finite,
/// constant, or nothing but noise are dropped, and so are those beyond the number of channels that the model holds.
/// Without steps.decide every allowed feature with a finite value takes part and is prefiltered. Throws
/// Error{CheckFailed} if the beauty has no finite pixel. sampled: as Preparation::sampled, which is not set here.
Preparation choose_features(const Frame& frame, const Steps& steps = {}, const Image& sampled = {});

/// Throws Error{CheckFailed} if the beauty has no finite pixel.
void require_usable(const Frame& frame);

}  // namespace polyrecon
