#pragma once

#include <cstddef>
#include <vector>

#include "polyrecon/error_map.h"
#include "polyrecon/frame.h"

namespace polyrecon {

/// Pixels that show a lamp, and what they hold. A polynomial of features that do not show the lamp cannot follow its
/// edge, so windows that contain both would spread its radiance; such pixels keep their values instead.
struct Lamps {
  Image others;                     ///< The mask (core/mask.h) of all other pixels; empty without lamps.
  std::vector<std::size_t> pixels;  ///< Indices of the pixels of lamps, in order.
  std::vector<Image> layers;        ///< Values of beauty and AOVs there: pixels.size() x 1.
  Image variance;                   ///< That of the beauty's mean there; empty where the file does not tell it.

  bool empty() const { return pixels.empty(); }
};

/// Finds the lamps of a frame. The brightness of a pixel is that of its brightest primary. Levels of brightness come
/// from the means of blocks of 8 x 8 pixels: B of the surroundings, below which a quarter of the 5 x 5 blocks around
/// lies, and P of the picture, below which nine tenths of all blocks lie. A pixel shows a lamp where
/// - the median of the 3 x 3 pixels around it is above 50 B, and at least four of its neighbours are equal to it within
///   1 %, as radiance is that the camera sees directly;
/// - or that median is above 300 B and above 100 P;
/// - or the pixel itself is, and holds more than 5 % of the energy of all others (a sun of one pixel).
/// The antialiased rim belongs to the lamp: pixels above 8 B, up to two pixels away. rendered: mask of the pixels that
/// are not void.
Lamps find_lamps(const Frame& frame, const Image& rendered);

/// Writes the values of the lamps' pixels into an image with the channels of ColorLayout: beauty, AOVs, alpha.
void put_lamps(const Lamps& lamps, const Frame& frame, Image& image);

/// Writes the error of the lamps' pixels into the error map of that image: they are the input, so it is their noise.
void put_errors(const Lamps& lamps, const Image& image, ErrorMap& error);

}  // namespace polyrecon
