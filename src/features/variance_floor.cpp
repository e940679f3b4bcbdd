#include "features/variance_floor.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"

namespace polyrecon {
namespace {

constexpr int radius = 2;
constexpr double part_of_mean = 0.3;

}  // namespace

Image floor_variance(const Image& variance) {
  Image out = variance;
  Progress silent;
  parallel_for(static_cast<std::size_t>(out.height()), silent, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    std::array<Real, std::size_t{2 * radius + 1} * std::size_t{2 * radius + 1}> around{};
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const Rect area = intersect(grow({x, y, x + 1, y + 1}, radius), out.bounds());
        double sum = 0;
        auto end = around.begin();
        for (int v = area.y0; v < area.y1; ++v)
          for (int u = area.x0; u < area.x1; ++u) {
            *end++ = variance.at(u, v, c);
            sum += static_cast<double>(variance.at(u, v, c));
          }
        const auto middle = around.begin() + (end - around.begin()) / 2;
        std::nth_element(around.begin(), middle, end);
        const auto mean = static_cast<Real>(part_of_mean * sum / static_cast<double>(area.area()));
        out.at(x, y, c) = std::max({variance.at(x, y, c), *middle, mean});
      }
  });
  return out;
}

}  // namespace polyrecon
