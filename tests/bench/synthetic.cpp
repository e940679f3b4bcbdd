#include "bench/synthetic.h"

#include <cmath>
#include <limits>

#include "regression/weights.h"
#include "support/images.h"
#include "support/random.h"

namespace polyrecon::bench {
namespace {

constexpr unsigned seed = 20160701;
constexpr double relative_noise = 0.2, feature_noise = 0.01;

double texture(int x, int y) { return (x / 7 + y / 5) % 2 == 0 ? 0.8 : 0.3; }

double light(int x, int y, int c) {
  const double smooth = 0.6 + 0.4 * std::sin(0.05 * x + 0.4 * c) * std::cos(0.04 * y);
  return (x + y) % 160 < 80 ? smooth : 0.25 * smooth;  // the edge of a shadow
}

double radiance(int x, int y, int c) { return light(x, y, c) * texture(x, y); }

double feature(int x, int y, int f) { return std::sin(0.03 * (f + 1) * x + f) * std::cos(0.02 * (8 - f) * y); }

}  // namespace

HalfPair synthetic_pair(int width, int height) {
  test::Random random(seed);
  HalfPair pair;
  for (Image& half : pair.color)
    half = test::image_of(width, height, 3, [&](int x, int y, int c) {
      return radiance(x, y, c) * (1 + relative_noise * random.normal());
    });
  pair.variance = test::image_of(width, height, 3, [](int x, int y, int c) {
    const double deviation = relative_noise * radiance(x, y, c);
    return deviation * deviation;
  });
  for (Image& half : pair.features)
    half = test::image_of(width, height, feature_channels,
                          [&](int x, int y, int f) { return feature(x, y, f) + feature_noise * random.normal(); });
  pair.epsilon = 1e-3;
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
  distances.load(pair.color[1], pair.variance, {x, y, x + 1, y + 1}, radius, {1});
  distances.window_of(x, y, {std::numeric_limits<Real>::max()}, window);
  gather({&pair.color[0], &pair.variance, &pair.features[1], &pair.color[1]}, layout, x, y, radius, window);
  return window;
}

}  // namespace polyrecon::bench
