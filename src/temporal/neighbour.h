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

/// Channels of a Neighbour.
inline std::size_t neighbour_channels(std::size_t color_channels) {
  return half_pair_channels(color_channels, 0) + geometry_channels;
}

}  // namespace polyrecon
