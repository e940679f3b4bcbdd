#include "core/repair.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/rect.h"

namespace polyrecon {
namespace {

bool pixel_usable(const Image& image, std::size_t i, Real largest) {
  for (int c = 0; c < image.channels(); ++c)
    if (!(std::abs(image.plane(c)[i]) <= largest)) return false;
  return true;
}

/// Computes the mean of the good neighbours of (x, y). Returns false if there are none.
bool neighbour_mean(const Image& image, const std::vector<unsigned char>& bad, int x, int y,
                    std::vector<double>& mean) {
  mean.assign(static_cast<std::size_t>(image.channels()), 0.0);
  int count = 0;
  const Rect around = intersect(grow({x, y, x + 1, y + 1}, 1), image.bounds());
  for (int v = around.y0; v < around.y1; ++v)
    for (int u = around.x0; u < around.x1; ++u) {
      const std::size_t i = image.index(u, v);
      if (bad[i]) continue;
      ++count;
      for (int c = 0; c < image.channels(); ++c)
        mean[static_cast<std::size_t>(c)] += static_cast<double>(image.plane(c)[i]);
    }
  for (double& m : mean) m /= std::max(count, 1);
  return count > 0;
}

}  // namespace

bool usable(Real value) { return std::abs(value) <= largest_value; }

Real largest_variance(const Image& mean) {
  constexpr double noisiest = 1e3;  // standard deviation over the mean radiance
  constexpr double largest = 1e30;  // the square of largest_value
  const double sum = ordered_sum(static_cast<std::size_t>(mean.height()), [&](std::size_t y) {
    double row = 0;
    for (int c = 0; c < mean.channels(); ++c) {
      const Real* values = mean.row(c, static_cast<int>(y));
      for (int x = 0; x < mean.width(); ++x)
        if (usable(values[x])) row += std::abs(static_cast<double>(values[x]));
    }
    return row;
  });
  const double deviation =
      noisiest * sum / static_cast<double>(mean.pixels() * static_cast<std::size_t>(mean.channels()));
  return static_cast<Real>(std::clamp(deviation * deviation, static_cast<double>(largest_value), largest));
}

bool has_usable_pixel(const Image& image) {
  for (std::size_t i = 0; i < image.pixels(); ++i)
    if (pixel_usable(image, i, largest_value)) return true;
  return false;
}

std::size_t repair_nonfinite(Image& image, int depth, Real largest) {
  if (image.empty()) return 0;
  std::vector<unsigned char> bad(image.pixels(), 0);
  for_rows(image.height(), [&](int y) {
    for (std::size_t i = image.index(0, y); i < image.index(0, y + 1); ++i) bad[i] = !pixel_usable(image, i, largest);
  });
  std::vector<std::size_t> holes;
  for (auto hole = bad.begin(); (hole = std::find(hole, bad.end(), 1)) != bad.end(); ++hole)
    holes.push_back(static_cast<std::size_t>(hole - bad.begin()));
  const std::size_t replaced = holes.size();
  std::vector<double> mean;
  for (int ring = 0; ring < depth && !holes.empty(); ++ring) {
    std::vector<std::size_t> repaired, rest;
    for (const std::size_t i : holes) {
      const int x = static_cast<int>(i % static_cast<std::size_t>(image.width()));
      const int y = static_cast<int>(i / static_cast<std::size_t>(image.width()));
      if (!neighbour_mean(image, bad, x, y, mean)) {
        rest.push_back(i);
        continue;
      }
      for (int c = 0; c < image.channels(); ++c)
        image.plane(c)[i] = static_cast<Real>(mean[static_cast<std::size_t>(c)]);
      repaired.push_back(i);
    }
    for (const std::size_t i : repaired) bad[i] = 0;
    holes = std::move(rest);
  }
  for (const std::size_t i : holes)
    for (int c = 0; c < image.channels(); ++c) image.plane(c)[i] = 0;
  return replaced;
}

}  // namespace polyrecon
