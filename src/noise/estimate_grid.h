#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// Estimates of the noise are made around every second pixel of a row and of a column: node (u, v) of a grid stands
/// for the pixels (2u..2u+1, 2v..2v+1).
constexpr int grid_stride = 2;

/// An image of one sample a node.
Image estimate_grid(const Image& image);

/// The median of the estimates of each node and those up to two nodes away, so that the few across an edge do not
/// matter. Negative values mean "none"; 0 where there are only these.
Image medians_around(const Image& grid);

}  // namespace polyrecon
