#pragma once

#include <cstddef>

#include "core/half_pair.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {

/// A frame prepared for use as a neighbour in time.
struct Neighbour {
  HalfPair pair;  ///< Without features; outliers are removed.
  Image motion;   ///< As Frame::motion; empty where there is none.
};

/// Channels of a Neighbour.
inline std::size_t neighbour_channels(std::size_t color_channels) {
  constexpr std::size_t motion = 4;
  return half_pair_channels(color_channels, 0) + motion;
}

}  // namespace polyrecon
