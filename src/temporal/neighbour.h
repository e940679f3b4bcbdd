#pragma once

#include "core/half_pair.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {

/// A frame as the frames before and after it need it.
struct Neighbour {
  HalfPair pair;  ///< Without features; outliers removed.
  Image motion;   ///< As Frame::motion; empty where there is none.
};

}  // namespace polyrecon
