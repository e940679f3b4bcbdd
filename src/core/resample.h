#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// The image at half the resolution, rounded up. Each pixel is the mean of the 2 x 2 pixels that it covers (fewer at
/// the border).
Image half_resolution(const Image& image);

/// The image at twice the resolution, cut to width x height: bilinear between the centres of the coarse pixels and
/// constant beyond them.
Image double_resolution(const Image& image, int width, int height);

/// The image reduced to a width of at most max_width pixels. Each pixel is the mean of a square block of pixels.
Image at_most_wide(const Image& image, int max_width);

}  // namespace polyrecon
