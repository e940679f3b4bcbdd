#pragma once

#include <cstddef>

#include "polyrecon/image.h"

// Masks of pixels: 1 channel, 1 inside and 0 outside; empty where all pixels are inside. core/void_pixels.h makes them.
namespace polyrecon {

inline bool in_mask(const Image& mask, std::size_t i) { return mask.empty() || mask.plane(0)[i] > 0; }

/// Number of pixels inside the mask, of `all`.
std::size_t mask_pixels(const Image& mask, std::size_t all);

/// The mask of the pixels that are inside both.
Image both_masks(const Image& a, const Image& b);

/// The image with a value in all pixels outside the mask. An empty image stays empty.
Image outside_set_to(Real value, const Image& mask, Image image);

/// Turns an average over the mask and 0 beyond it into the average over the mask alone. share: the same average
/// of the mask; where it is 0 the result is 0.
Image divided_by_share(Image average, const Image& share);

}  // namespace polyrecon
