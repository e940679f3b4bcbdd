#pragma once

#include <array>
#include <vector>

#include "polyrecon/image.h"
#include "temporal/follow.h"
#include "temporal/geometry.h"

namespace polyrecon {

constexpr int band_rows = 256;            // Rows of a frame that are estimated at once.
constexpr double least_variance = 1e-30;  // A variance up to it counts as none.

/// An estimate of the current frame from other frames; zero where it is not valid.
struct Estimate {
  std::array<Image, 2> color;
  Image variance;  ///< Noise variance of one half, 3 channels.
  std::array<Image, surfaces> surface;
  std::vector<unsigned char> valid;  ///< One byte per pixel.
};

/// The estimate of the pixels of area from the frames k before and k after; empty if there are none.
/// all: places in all neighbours.
Estimate estimate_at(const std::vector<Places>& all, int k, const Rect& area);

}  // namespace polyrecon
