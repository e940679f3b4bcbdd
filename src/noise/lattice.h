#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// Estimates of the noise are made around every second pixel of a row and of a column: node (u, v) of a lattice stands
/// for the pixels (2u..2u+1, 2v..2v+1).
constexpr int lattice_stride = 2;

/// An image of one sample a node.
Image lattice_of(const Image& image);

/// The median of the estimates of each node and those up to two nodes away, so that the few across an edge do not
/// matter. Negative values mean "none"; 0 where there are only these.
Image medians_around(const Image& lattice);

}  // namespace polyrecon
