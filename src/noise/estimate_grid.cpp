#include "noise/estimate_grid.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "core/rect.h"

namespace polyrecon {
namespace {

constexpr int median_radius = 2;  // nodes

}  // namespace

Image estimate_grid(const Image& image) {
  const auto nodes = [](int pixels) { return (pixels + grid_stride - 1) / grid_stride; };
  return Image(nodes(image.width()), nodes(image.height()), image.channels());
}

Image medians_around(const Image& grid) {
  Image out(grid.width(), grid.height(), grid.channels());
  for_rows(out.height(), [&](int y) {
    std::vector<Real> estimates;
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const Rect area = intersect(grow({x, y, x + 1, y + 1}, median_radius), grid.bounds());
        estimates.clear();
        for (int v = area.y0; v < area.y1; ++v)
          for (int u = area.x0; u < area.x1; ++u)
            if (grid.at(u, v, c) >= 0) estimates.push_back(grid.at(u, v, c));
        if (estimates.empty()) continue;
        const auto middle = estimates.begin() + static_cast<std::ptrdiff_t>(estimates.size() / 2);
        std::nth_element(estimates.begin(), middle, estimates.end());
        out.at(x, y, c) = *middle;
      }
  });
  return out;
}

}  // namespace polyrecon
