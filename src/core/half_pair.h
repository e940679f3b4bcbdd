#pragma once

#include <array>
#include <cstddef>

#include "polyrecon/image.h"

namespace polyrecon {

/// Two independent halves of a frame's samples, ready for the fit: every value is finite. The weights and features that
/// one half is fitted with come from the other half, so that no pixel's noise decides on its own weight; the average of
/// the two fits is the result.
struct HalfPair {
  std::array<Image, 2> color;     ///< See ColorLayout (core/color_layout.h).
  Image variance;                 ///< Noise variance of one half's beauty, 3 channels, >= 0.
  std::array<Image, 2> features;  ///< Prepared features, one channel per regressor, at most
                                  ///< BasisLayout::max_features (regression/basis.h); 0 channels where there are none.
  double epsilon = 0;             ///< Added to squared radiance when errors are compared relative to it; > 0.
  Image sampled = {};  ///< Mask of the pixels that count as samples (core/void_pixels.h). Colours and variance of
                       ///< others continue the samples next to them; no window and no average takes them.
  Image bound = {};    ///< See noise_bound (blend/noise_bound.h), 1 channel; empty where pixels are not bound.

  int width() const { return variance.width(); }
  int height() const { return variance.height(); }
};

/// The part of a pair inside r.
HalfPair crop(const HalfPair& pair, const Rect& r);

/// Channels of all images of a pair.
std::size_t half_pair_channels(std::size_t color_channels, std::size_t feature_channels);

}  // namespace polyrecon
