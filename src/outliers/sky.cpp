#include "outliers/sky.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/mask.h"
#include "core/parallel.h"
#include "core/rect.h"

namespace polyrecon {
namespace {

constexpr int neighbourhood = 2;  // pixels around one
constexpr double height = 3;      // above the median, in units of (third brightest around - median)

const Image* mean_of(const Frame& frame, Role role) {
  for (const Feature& feature : frame.features)
    if (feature.role == role && feature.pass.mean.channels() == 3) return &feature.pass.mean;
  return nullptr;
}

bool is_zero(const Image& image, std::size_t i) {
  return image.plane(0)[i] == 0 && image.plane(1)[i] == 0 && image.plane(2)[i] == 0;
}

double sum_of_channels(const Image& image, std::size_t i) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += static_cast<double>(image.plane(c)[i]);
  return sum;
}

/// Whether a pixel of an image is far brighter than all but two of those around it. Not where a value is not finite.
bool has_spike(const Image& image, int x, int y) {
  const double value = sum_of_channels(image, image.index(x, y));
  const Rect area = intersect(grow({x, y, x + 1, y + 1}, neighbourhood), image.bounds());
  std::vector<double> around;
  for (int v = area.y0; v < area.y1; ++v)
    for (int u = area.x0; u < area.x1; ++u) {
      if (u == x && v == y) continue;
      around.push_back(sum_of_channels(image, image.index(u, v)));
      if (!std::isfinite(around.back())) return false;
    }
  if (around.size() < 3) return false;
  const auto third = around.end() - 3, middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
  std::nth_element(around.begin(), third, around.end());
  const double top = *third;
  std::nth_element(around.begin(), middle, around.end());
  return value > top && value - *middle > height * (top - *middle);
}

}  // namespace

Image firefly_mask(const Frame& frame) {
  const Image *normal = mean_of(frame, Role::Normal), *albedo = mean_of(frame, Role::Albedo);
  if (!normal || !albedo) return {};
  Image mask(frame.width(), frame.height(), 1, Real(1));
  for_rows(mask.height(), [&](int y) {
    for (int x = 0; x < mask.width(); ++x) {
      const std::size_t i = mask.index(x, y);
      if (is_zero(*normal, i) && (is_zero(*albedo, i) || has_spike(*albedo, x, y))) mask.plane(0)[i] = 0;
    }
  });
  return mask_pixels(mask, mask.pixels()) < mask.pixels() ? mask : Image();
}

}  // namespace polyrecon
