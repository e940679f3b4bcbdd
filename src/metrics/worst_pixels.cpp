#include "metrics/worst_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace polyrecon {

std::vector<WorstPixel> worst_pixels(const Image& values, std::size_t count, int distance) {
  std::vector<WorstPixel> found;
  // One pass for each pixel that is found: the largest value that is not near one found before.
  while (found.size() < count) {
    WorstPixel worst;
    for (int y = 0; y < values.height(); ++y)
      for (int x = 0; x < values.width(); ++x) {
        const double value = values.at(x, y, 0);
        if (!(value > worst.value) || !std::isfinite(value)) continue;
        if (std::none_of(found.begin(), found.end(), [&](const WorstPixel& other) {
              return std::abs(other.x - x) <= distance && std::abs(other.y - y) <= distance;
            }))
          worst = {x, y, value};
      }
    if (!(worst.value > 0)) break;
    found.push_back(worst);
  }
  return found;
}

}  // namespace polyrecon
