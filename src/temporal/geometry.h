#pragma once

#include <array>
#include <cstddef>

#include "polyrecon/frame.h"
#include "polyrecon/image.h"
#include "polyrecon/roles.h"

namespace polyrecon {

/// Kinds of passes that show which surface a pixel sees.
constexpr std::size_t surfaces = static_cast<std::size_t>(Surface::None);

constexpr std::size_t index_of(Surface surface) { return static_cast<std::size_t>(surface); }

/// Motion, which says where the points of a frame are in another frame, and surfaces, which say whether a pixel shows
/// the same one there.
struct Geometry {
  Rect window;                          ///< As Frame::data_window.
  Image motion;                         ///< As Frame::motion.
  std::array<Image, surfaces> surface;  ///< By index_of; the logarithm of the distance; empty where unknown.
};

/// Channels of a Geometry.
std::size_t geometry_channels();

/// The geometry of a frame; its passes are copied and made finite.
Geometry geometry_of(const Frame& frame);

/// Noise variance of the mean of each surface, summed over its channels, 1 channel each; empty where it is unknown.
std::array<Image, surfaces> surface_noise(const Frame& frame);

/// The part inside r, which counts from the upper left pixel of the window; without motion.
Geometry crop(const Geometry& geometry, const Rect& r);

}  // namespace polyrecon
