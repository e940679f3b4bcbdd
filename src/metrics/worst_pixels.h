#pragma once

#include <cstddef>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

struct WorstPixel {
  int x = 0, y = 0;
  double value = 0;
};

/// The pixels of the largest finite values (1 channel) above 0, the largest first, at most `count`. None lies within
/// `distance` columns and rows of a larger one, so that each shows another place.
std::vector<WorstPixel> worst_pixels(const Image& values, std::size_t count, int distance);

}  // namespace polyrecon
