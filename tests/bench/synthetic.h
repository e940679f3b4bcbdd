#pragma once

#include <vector>

#include "core/half_pair.h"
#include "polyrecon/image.h"
#include "regression/basis.h"
#include "regression/window.h"

namespace polyrecon::bench {

constexpr int feature_channels = 8;  ///< Normal, albedo, depth and visibility: what a full set of passes has.

/// A noisy frame of the given size: smooth light with edges times a checkered texture, relative noise of 20 %, features
/// with a little noise of their own. The same for the same size in every run.
HalfPair synthetic_pair(int width, int height);

/// Pixels of the image at every stride-th column and row of block.
struct Centers {
  std::vector<int> x, y;
};
Centers lattice(const Rect& block, int stride);

/// The whole window of the given radius around the middle of pair, none of its pixels left out.
Window full_window(const HalfPair& pair, const BasisLayout& layout, int radius);

}  // namespace polyrecon::bench
