#include "bench/synthetic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "regression/weights.h"

namespace polyrecon::bench {
namespace {

constexpr unsigned seed = 20160701;
constexpr double relative_noise = 0.2, feature_noise = 0.01;

double texture(int x, int y) { return (x / 7 + y / 5) % 2 == 0 ? 0.8 : 0.3; }

double light(int x, int y, int c) {
  const double smooth = 0.6 + 0.4 * std::sin(0.05 * x + 0.4 * c) * std::cos(0.04 * y);
  return (x + y) % 160 < 80 ? smooth : 0.25 * smooth;  // the edge of a shadow
}

double feature(int x, int y, int f) { return std::sin(0.03 * (f + 1) * x + f) * std::cos(0.02 * (8 - f) * y); }

}  // namespace

HalfPair synthetic_pair(int width, int height) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  HalfPair pair{{Image(width, height, 3), Image(width, height, 3)},
                Image(width, height, 3),
                {Image(width, height, feature_channels), Image(width, height, feature_channels)},
                1e-3};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double mean = light(x, y, c) * texture(x, y), deviation = relative_noise * mean;
        for (Image& half : pair.color) half.at(x, y, c) = static_cast<Real>(mean + deviation * normal(random));
        pair.variance.at(x, y, c) = static_cast<Real>(deviation * deviation);
      }
      for (int f = 0; f < feature_channels; ++f)
        for (Image& half : pair.features)
          half.at(x, y, f) = static_cast<Real>(feature(x, y, f) + feature_noise * normal(random));
    }
  return pair;
}

Centers lattice(const Rect& block, int stride) {
  Centers centers;
  for (int y = block.y0; y < block.y1; y += stride)
    for (int x = block.x0; x < block.x1; x += stride) {
      centers.x.push_back(x);
      centers.y.push_back(y);
    }
  return centers;
}

Window full_window(const HalfPair& pair, const BasisLayout& layout, int radius) {
  const int x = pair.width() / 2, y = pair.height() / 2;
  Window window;
  window.reserve(radius, layout.columns(), 3);
  PatchDistances distances;
  distances.compute(pair.color[1], pair.variance, {x, y, x + 1, y + 1}, {x}, {y}, radius, 1);
  distances.window_of(0, std::numeric_limits<Real>::max(), window);
  gather({&pair.color[0], &pair.variance, &pair.features[1], &pair.color[1]}, layout, x, y, radius, window);
  return window;
}

}  // namespace polyrecon::bench
