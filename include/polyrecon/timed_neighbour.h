// A frame before or after the one that is reconstructed.
#pragma once

namespace polyrecon {

/// A frame as those before and after it need it; made by prepare_neighbour (polyrecon/reconstruct.h).
struct Neighbour;

/// A neighbour in time.
struct TimedNeighbour {
  int offset = 0;                    ///< Frames after the one that is reconstructed; negative: before it.
  const Neighbour* frame = nullptr;  ///< Must outlive the call.
};

}  // namespace polyrecon
