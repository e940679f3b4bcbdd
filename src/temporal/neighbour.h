#pragma once

#include "core/half_pair.h"
#include "core/image.h"

namespace polyrecon {

/// A frame as the frames before and after it need it.
struct Neighbour {
  HalfPair pair;  ///< Without features; outliers removed.
  Image motion;   ///< As Frame::motion; empty where there is none.
};

/// A neighbour and its place in time: `offset` frames after the frame in hand (before it where negative).
struct TimedNeighbour {
  int offset = 0;
  const Neighbour* frame = nullptr;
};

}  // namespace polyrecon
