#include "blend/undershoot.h"

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "core/color_layout.h"
#include "core/parallel.h"
#include "core/rect.h"

namespace polyrecon {
namespace {

constexpr int around_radius = 2;

double sum_over(const Image& image, int channel, const Rect& area) {
  double sum = 0;
  for (int y = area.y0; y < area.y1; ++y)
    for (int x = area.x0; x < area.x1; ++x) sum += static_cast<double>(image.at(x, y, channel));
  return sum;
}

Real least_over(const Image& image, int channel, const Rect& area) {
  Real least = image.at(area.x0, area.y0, channel);
  for (int y = area.y0; y < area.y1; ++y) {
    const Real* row = image.row(channel, y);
    least = std::min(least, *std::min_element(row + area.x0, row + area.x1));
  }
  return least;
}

/// Raises a channel of the beauty by `by` and the same colour of the AOVs by their shares.
void raise(const Image& input, const Rect& around, int channel, Real by, int x, int y, Image& image) {
  image.at(x, y, channel) += by;
  const double beauty = sum_over(input, channel, around);
  if (beauty == 0) return;
  // A part of the beauty is 0 to 1 of it. The limits are for layers that are not a part, such as an albedo, which may
  // be any multiple of the beauty in a dark corner.
  for (int layer = 1; layer < ColorLayout(image.channels()).layers(); ++layer) {
    const int k = ColorLayout::channel(layer, channel);
    image.at(x, y, k) +=
        static_cast<Real>(static_cast<double>(by) * std::clamp(sum_over(input, k, around) / beauty, 0.0, 1.0));
  }
}

}  // namespace

std::size_t raise_undershoot(const Image& input, Image& image) {
  std::atomic<std::size_t> raised{0};
  for_rows(image.height(), [&](int y) {
    for (int x = 0; x < image.width(); ++x) {
      const Rect around = intersect(grow({x, y, x + 1, y + 1}, around_radius), image.bounds());
      bool any = false;
      for (int c = 0; c < 3; ++c) {
        // A value that is not below the input of its pixel is not below all inputs around it.
        if (image.at(x, y, c) >= input.at(x, y, c)) continue;
        const Real least = least_over(input, c, around);
        if (image.at(x, y, c) >= least) continue;
        raise(input, around, c, least - image.at(x, y, c), x, y, image);
        any = true;
      }
      raised += any;
    }
  });
  return raised;
}

}  // namespace polyrecon
