#pragma once

#include <array>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

/// Feature channels that a local model can hold (regression/basis.h).
constexpr int max_feature_channels = 16;

/// Two independent halves of a frame's samples, ready for the fit: every value finite. What one half is fitted with
/// (weights, features) comes from the other, so that no pixel's noise can vote for itself; the average of the two is
/// the result.
struct HalfPair {
  std::array<Image, 2> color;     ///< Beauty, then each AOV: 3 channels each.
  Image variance;                 ///< Noise variance of one half's beauty, 3 channels, >= 0.
  std::array<Image, 2> features;  ///< Prepared features, one channel per regressor, at most
                                  ///< max_feature_channels; 0 channels where there are none.
  double epsilon = 0;             ///< What is added to squared radiance when errors are compared relative to it; > 0.

  int width() const { return variance.width(); }
  int height() const { return variance.height(); }
};

/// The part of a pair inside r.
HalfPair crop(const HalfPair& pair, const Rect& r);

}  // namespace polyrecon
