#pragma once

#include <cstddef>

#include "polyrecon/image.h"

namespace polyrecon {

/// Largest magnitude that counts as a value: its square and sums of squares still fit into a float.
constexpr Real largest_value = Real(1e15);

/// True for a finite value of a magnitude that can be computed with.
bool usable(Real value);

/// Whether some pixel is usable in all channels.
bool has_usable_pixel(const Image& image);

/// Replaces unusable pixels by the mean of the usable ones around them, growing inwards from the border of a hole; at
/// most `reach` pixels deep, deeper ones become 0. Returns how many pixels were replaced.
std::size_t repair_nonfinite(Image& image, int reach);

}  // namespace polyrecon
