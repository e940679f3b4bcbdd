#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// Half the resolution (rounded up): each pixel the mean of the 2 x 2 (at the border fewer) pixels it covers.
Image half_resolution(const Image& image);

/// Twice the resolution, cut to width x height: bilinear between the centres of the coarse pixels, constant beyond
/// them.
Image double_resolution(const Image& image, int width, int height);

/// Means over square blocks, as large as it takes for the picture to be at most so many pixels wide.
Image at_most_wide(const Image& image, int widest);

}  // namespace polyrecon
