#pragma once

#include <cstddef>

#include "polyrecon/image.h"

namespace polyrecon {

/// Largest magnitude of a usable value. Its square and sums of squares fit into a float.
constexpr Real largest_value = Real(1e15);

/// Depth to which holes of passes are filled, in pixels: the values around a larger hole say nothing of its middle.
constexpr int repair_depth = 8;

/// Whether a value is finite and its magnitude at most largest_value.
bool usable(Real value);

/// Whether some pixel is usable in all channels.
bool has_usable_pixel(const Image& image);

/// Replaces unusable pixels, with a value that is not finite or beyond `largest`, by the mean of the usable ones next
/// to them, from the border of a hole inwards. Pixels more than `depth` pixels inside a hole become 0. Returns the
/// number of replaced pixels.
std::size_t repair_nonfinite(Image& image, int depth, Real largest = largest_value);

/// Largest usable noise variance of an image: largest_value, or more where the image is so bright that the variance of
/// its noise must be beyond that.
Real largest_variance(const Image& mean);

}  // namespace polyrecon
