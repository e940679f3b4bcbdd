#include "core/mean.h"

#include <cstddef>
#include <limits>

#include "core/parallel.h"

namespace polyrecon {

double mean_of(const Image& image) {
  if (image.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double sum = ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t y) {
    double row = 0;
    for (int x = 0; x < image.width(); ++x) row += static_cast<double>(image.at(x, static_cast<int>(y), 0));
    return row;
  });
  return sum / static_cast<double>(image.pixels());
}

double mean_samples(const Image& counts) { return counts.empty() ? 0 : mean_of(counts); }

}  // namespace polyrecon
