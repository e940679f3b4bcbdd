#pragma once

#include <vector>

#include "polyrecon/image.h"
#include "temporal/neighbour.h"

namespace polyrecon {

/// The place in a neighbouring frame of the point that each pixel shows.
struct Places {
  int offset = 0;  ///< Distance of the neighbouring frame, in frames.
  const Neighbour* frame = nullptr;
  Image position;                   ///< 2 channels: column and row in that frame's image, in pixels, fractional.
  std::vector<unsigned char> seen;  ///< Per pixel, 0 where the point is hidden in that frame or outside of it.
};

/// Follows the motion vectors from frame to frame, backward and forward in time. A point is seen in a frame if the
/// vectors of that frame lead back to within a pixel of where the point was. Where a frame has no vectors, points are
/// taken not to move. Frames are joined by the coordinates of the file, whatever their data windows. A direction ends
/// at the first frame that is missing, or whose layers differ from pair's. geometry: of the current frame. neighbours:
/// each offset at most once.
std::vector<Places> follow(const Geometry& geometry, const HalfPair& pair,
                           const std::vector<TimedNeighbour>& neighbours);

/// An image of a neighbour, sampled at the places of the pixels of area; 0 where a pixel is not seen. sharp: cubic
/// interpolation (Catmull and Rom 1974), which keeps detail; otherwise linear, which keeps the sign.
Image sample_at(const Image& image, const Places& places, const Rect& area, bool sharp);

}  // namespace polyrecon
