#pragma once

#include <vector>

#include "polyrecon/image.h"
#include "temporal/neighbour.h"

namespace polyrecon {

/// Where each pixel's point is in a neighbouring frame.
struct Places {
  int offset = 0;  ///< Of that frame.
  const Neighbour* frame = nullptr;
  Image position;                   ///< 2 channels: column and row there, in pixels, fractional.
  std::vector<unsigned char> seen;  ///< 0 where the point is hidden there, or outside the picture.
};

/// Follows the motion vectors from frame to frame. A point counts as seen as long as the way back, by the vectors of
/// the frame that was reached, ends within a pixel of where it began. Where a frame has no vectors the point is taken
/// to stand still. A side ends at the first frame that is not there, or has another size or other layers than pair.
/// motion: of the frame in hand, as Frame::motion. Every offset at most once.
std::vector<Places> follow(const Image& motion, const HalfPair& pair, const std::vector<TimedNeighbour>& neighbours);

/// A neighbour's image at the places of the pixels of area, where they are seen, else 0. sharp: by the cubic of Catmull
/// and Rom (1974), which keeps detail; else linear, which keeps the sign.
Image sample_at(const Image& image, const Places& places, const Rect& area, bool sharp);

}  // namespace polyrecon
