#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// The image at half the resolution, rounded up. Each pixel is the mean of the 2 x 2 pixels that it covers (fewer at
/// the border).
Image half_resolution(const Image& image);

/// The same over the pixels inside a mask (core/mask.h); 0 where there are none.
Image half_resolution(const Image& image, const Image& mask);

/// The image at twice the resolution, cut to width x height: bilinear between the centres of the coarse pixels and
/// constant beyond them.
Image double_resolution(const Image& image, int width, int height);

/// The same over the coarse pixels inside a mask; 0 where there are none.
Image double_resolution(const Image& image, int width, int height, const Image& mask);

/// The image reduced by a whole factor. Each pixel is the mean of the factor x factor pixels that it covers (fewer at
/// the border).
Image reduced(const Image& image, int factor);

}  // namespace polyrecon
