#include "noise/spike_variance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "core/real.h"
#include "core/rect.h"

namespace polyrecon {
namespace {

constexpr int block = 5;           // pixels
constexpr int block_radius = 2;    // blocks
constexpr std::size_t others = 3;  // blocks that must have a spike as high
// Part of the squared excess that counts as variance. With all of it, highlights of the scene lose more than the noise
// of spikes is reduced.
constexpr Real share = Real(0.5);

/// How far a pixel exceeds the second brightest of its neighbours, less what rounding to half floats may contribute.
double excess(const Image& image, int x, int y, int c) {
  Real brightest = std::numeric_limits<Real>::lowest(), second = brightest;
  for (int v = y - 1; v <= y + 1; ++v)
    for (int u = x - 1; u <= x + 1; ++u) {
      if (u == x && v == y) continue;
      const Real value = image.at(std::clamp(u, 0, image.width() - 1), std::clamp(v, 0, image.height() - 1), c);
      second = std::max(second, std::min(brightest, value));
      brightest = std::max(brightest, value);
    }
  const double value = image.at(x, y, c), other = second;
  return std::max(value - other - half_float_rounding * (std::abs(value) + std::abs(other)), 0.0);
}

/// The maximum of each block.
Image block_maxima(const Image& image) {
  Image out((image.width() + block - 1) / block, (image.height() + block - 1) / block, image.channels());
  for_rows(out.height(), [&](int row) {
    for (int c = 0; c < image.channels(); ++c)
      for (int y = row * block; y < std::min((row + 1) * block, image.height()); ++y)
        for (int x = 0; x < image.width(); ++x) {
          Real& highest = out.at(x / block, row, c);
          highest = std::max(highest, image.at(x, y, c));
        }
  });
  return out;
}

/// The highest value that `others` further blocks around each block also reach; 0 where there are too few blocks.
Image exceeded_by_others(const Image& maxima) {
  Image out(maxima.width(), maxima.height(), maxima.channels());
  for_rows(out.height(), [&](int y) {
    std::vector<Real> around;
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const Rect area = intersect(grow({x, y, x + 1, y + 1}, block_radius), maxima.bounds());
        around.clear();
        for (int v = area.y0; v < area.y1; ++v)
          for (int u = area.x0; u < area.x1; ++u) around.push_back(maxima.at(u, v, c));
        if (around.size() <= others) continue;
        const auto last = around.begin() + static_cast<std::ptrdiff_t>(others);
        std::nth_element(around.begin(), last, around.end(), std::greater<>());
        out.at(x, y, c) = *last;
      }
  });
  return out;
}

}  // namespace

Image spike_variance(const Image& radiance) {
  Image out(radiance.width(), radiance.height(), radiance.channels());
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const double e = excess(radiance, x, y, c);
        out.at(x, y, c) = share * storable(e * e);
      }
  });
  const Image limit = exceeded_by_others(block_maxima(out));
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x)
        out.at(x, y, c) = std::min(out.at(x, y, c), limit.at(x / block, y / block, c));
  });
  return out;
}

}  // namespace polyrecon
