#pragma once

#include <cstddef>

#include "polyrecon/image.h"

// Masks that tell where an image holds a picture: 1 channel, 1 or 0; empty where all pixels do. core/picture.h makes
// them.
namespace polyrecon {

inline bool in_picture(const Image& picture, std::size_t i) { return picture.empty() || picture.plane(0)[i] > 0; }

/// Number of pixels that hold a picture, of `all`.
std::size_t picture_pixels(const Image& picture, std::size_t all);

/// The image with a value in all pixels outside the picture. An empty image stays empty.
Image outside_set_to(Real value, const Image& picture, Image image);

/// Turns an average over the picture and 0 beyond it into the average over the picture alone. share: the same average
/// of the mask; where it is 0 the result is 0.
Image divided_by_share(Image average, const Image& share);

}  // namespace polyrecon
