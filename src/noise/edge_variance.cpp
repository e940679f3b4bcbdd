#include "noise/edge_variance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/mask.h"
#include "core/parallel.h"
#include "core/real.h"
#include "core/rect.h"
#include "core/spectrum_corner.h"
#include "noise/estimate_grid.h"

namespace polyrecon {
namespace {

constexpr int taps = static_cast<int>(corner_taps.size());
constexpr int mean_radius = 3;    // places
constexpr int rim_radius = 1;     // pixels
constexpr double stratified = 4;  // twice what rims of lamps rendered by Cycles show at 16, 64 and 256 samples
constexpr Real margin = Real(1.4);

/// Sum of the taps times values that are step apart.
Real convolved(const Real* in, std::ptrdiff_t step) {
  Real sum = 0;
  for (int k = 0; k < taps; ++k) sum += static_cast<Real>(corner_taps[static_cast<std::size_t>(k)]) * in[k * step];
  return sum;
}

/// Whether all pixels under the kernel at a place are inside the mask.
bool all_in_mask(const Image& mask, int x, int y) {
  if (mask.empty()) return true;
  for (int v = y; v < y + taps; ++v)
    for (int u = x; u < x + taps; ++u)
      if (!in_mask(mask, mask.index(u, v))) return false;
  return true;
}

/// The square of the convolution at each place, which covers the pixels (x..x+3, y..y+3); -1 where one of these is not
/// inside the mask.
Image squared_corner(const Image& y, const Image& mask) {
  const int width = y.width() - taps + 1, height = y.height() - taps + 1;
  Image along(width, y.height(), y.channels()), out(width, height, y.channels());
  for_rows(along.height(), [&](int v) {
    for (int c = 0; c < y.channels(); ++c)
      for (int x = 0; x < width; ++x)
        along.at(x, v, c) = convolved(y.row(c, v) + x, 1) / static_cast<Real>(corner_gain);
  });
  for_rows(height, [&](int v) {
    for (int c = 0; c < y.channels(); ++c)
      for (int x = 0; x < width; ++x) {
        const auto both = static_cast<double>(convolved(along.row(c, v) + x, width));
        out.at(x, v, c) = all_in_mask(mask, x, v) ? storable(both * both) : Real(-1);
      }
  });
  return out;
}

/// Mean of the values of an area that are not negative; -1 where there are none.
Real mean_over(const Image& image, const Rect& area, int c) {
  double sum = 0;
  int count = 0;
  for (int v = area.y0; v < area.y1; ++v)
    for (int u = area.x0; u < area.x1; ++u)
      if (const Real value = image.at(u, v, c); value >= 0) {
        sum += static_cast<double>(value);
        ++count;
      }
  return count > 0 ? storable(sum / count) : Real(-1);
}

}  // namespace

Image corner_variance(const Image& y, const Image& mask) {
  Image out(y.width(), y.height(), y.channels());
  if (y.width() < taps || y.height() < taps) return out;
  const Image squares = squared_corner(y, mask);
  Image means = estimate_grid(y);
  for_rows(means.height(), [&](int v) {
    for (int x = 0; x < means.width(); ++x) {
      // The middle of the kernel at place (x, y) is half a pixel beyond pixel (x + 1, y + 1).
      const int px = x * grid_stride - 1, py = v * grid_stride - 1;
      const Rect area = intersect(grow({px, py, px + 1, py + 1}, mean_radius), squares.bounds());
      for (int c = 0; c < y.channels(); ++c) means.at(x, v, c) = mean_over(squares, area, c);
    }
  });
  const Image medians = medians_around(means);
  for_rows(out.height(), [&](int v) {
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) out.at(x, v, c) = medians.at(x / grid_stride, v / grid_stride, c);
  });
  return out;
}

Image two_value_variance(const Image& y, const Image& samples) {
  Image out(y.width(), y.height(), y.channels());
  for_rows(out.height(), [&](int v) {
    for (int x = 0; x < out.width(); ++x) {
      const auto n = static_cast<double>(samples.at(x, v, 0));
      if (!(n > 0)) continue;
      const Rect area = intersect(grow({x, v, x + 1, v + 1}, rim_radius), y.bounds());
      for (int c = 0; c < y.channels(); ++c) {
        Real low = y.at(x, v, c), high = low;
        for (int t = area.y0; t < area.y1; ++t) {
          const auto [least, most] = std::minmax_element(y.row(c, t) + area.x0, y.row(c, t) + area.x1);
          low = std::min(low, *least);
          high = std::max(high, *most);
        }
        const double value = y.at(x, v, c), above = high - value, below = value - low;
        out.at(x, v, c) = storable(above * below / n * std::min(1.0, stratified / std::sqrt(n)));
      }
    }
  });
  return out;
}

Image edge_variance(const Image& y, const Image& samples, const Image& mask) {
  Image out = corner_variance(y, mask);
  const Image most = two_value_variance(y, samples);
  for_rows(out.height(), [&](int v) {
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) out.at(x, v, c) = margin * std::min(out.at(x, v, c), most.at(x, v, c));
  });
  return out;
}

}  // namespace polyrecon
