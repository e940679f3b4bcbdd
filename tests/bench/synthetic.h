#pragma once

#include <vector>

#include "core/half_pair.h"
#include "polyrecon/image.h"
#include "regression/basis.h"
#include "regression/window.h"

namespace polyrecon::bench {

constexpr int feature_channels = 8;  ///< Normal, albedo, depth and visibility.

/// A noisy frame of the given size: smooth light with edges times a checkered texture, with 20 % relative noise and
/// slightly noisy features. Every run makes the same frame.
HalfPair synthetic_pair(int width, int height);

/// Pixels at every stride-th column and row of block.
struct Centers {
  std::vector<int> x, y;
};
Centers lattice(const Rect& block, int stride);

/// The window of the given radius around the middle of pair, with all its pixels.
Window full_window(const HalfPair& pair, const BasisLayout& layout, int radius);

}  // namespace polyrecon::bench
