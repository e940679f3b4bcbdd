#pragma once

#include <cstddef>

#include "core/half_pair.h"
#include "polyrecon/timed_neighbour.h"
#include "temporal/geometry.h"

namespace polyrecon {

/// A frame prepared for use as a neighbour in time.
struct Neighbour {
  HalfPair pair;  ///< Without features; outliers are removed.
  Geometry geometry;
};

/// Whether a pixel has noise in any of its three colours.
inline bool is_noisy(const Image& variance, int x, int y) {
  return variance.at(x, y, 0) > 0 || variance.at(x, y, 1) > 0 || variance.at(x, y, 2) > 0;
}

/// Channels of a Neighbour.
inline std::size_t neighbour_channels(std::size_t color_channels) {
  return half_pair_channels(color_channels, 0) + geometry_channels();
}

}  // namespace polyrecon
