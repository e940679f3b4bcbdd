#pragma once

#include <cmath>

#include "core/half_pair.h"
#include "polyrecon/frame.h"
#include "support/images.h"
#include "support/random.h"

namespace polyrecon::test {

/// A noisy frame and its true image.
struct Scene {
  Frame frame;
  Image truth;
};

/// A textured plane with a bright disk, under smooth light. The texture is in the albedo, the disk in the normals. The
/// noise is Gaussian with standard deviation noise x (truth + 0.1); the frame has half buffers and exact variance.
inline Scene make_scene(int width, int height, double noise, std::uint64_t seed) {
  const auto albedo = [](int x, int y, int c) { return 0.5 + 0.2 * (((x / 6) + (y / 6)) % 2) + 0.1 * c; };
  const auto on_disk = [&](int x, int y) {
    const double dx = x - 0.4 * width, dy = y - 0.5 * height, r = 0.25 * std::min(width, height);
    return dx * dx + dy * dy < r * r;
  };
  const auto truth = [&](int x, int y, int c) {
    const double light = 1 + 0.5 * std::sin(0.07 * x + 0.05 * y + c) + (on_disk(x, y) ? 1.5 : 0);
    return albedo(x, y, c) * light;
  };
  Scene scene;
  scene.truth = image_of(width, height, 3, truth);
  Random random(seed);
  Pass& beauty = scene.frame.beauty;
  beauty.name = "Combined";
  const auto sigma = [&](int x, int y, int c) { return noise * (truth(x, y, c) + 0.1); };
  const auto half = [&](int x, int y, int c) {
    return truth(x, y, c) + std::sqrt(2.0) * sigma(x, y, c) * random.normal();
  };
  beauty.half_a = image_of(width, height, 3, half);
  beauty.half_b = image_of(width, height, 3, half);
  beauty.mean = mean_of(beauty.half_a, beauty.half_b);
  beauty.variance = image_of(width, height, 3, [&](int x, int y, int c) { return sigma(x, y, c) * sigma(x, y, c); });
  scene.frame.data_window = {0, 0, width, height};
  scene.frame.features = {
      {Role::Albedo, {"Albedo", image_of(width, height, 3, albedo), {}, {}, {}}},
      {Role::Normal,
       {"Normal",
        image_of(width, height, 3, [&](int x, int y, int c) { return c == (on_disk(x, y) ? 0 : 2) ? 1 : 0; }),
        {},
        {},
        {}}},
      {Role::Depth,
       {"Depth",
        image_of(width, height, 1,
                 [&](int x, int y, int) {
                   return 5 + 0.8 * std::sin(0.9 * x) * std::sin(0.7 * y) - (on_disk(x, y) ? 1 : 0);
                 }),
        {},
        {},
        {}}}};
  return scene;
}

/// relMSE against a noise-free reference: mean of (image - truth)^2 / (truth^2 + 0.01).
inline double relative_mse(const Image& image, const Image& truth) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < truth.pixels(); ++i) {
      const double t = static_cast<double>(truth.plane(c)[i]), d = static_cast<double>(image.plane(c)[i]) - t;
      sum += d * d / (t * t + 0.01);
    }
  return sum / (3.0 * static_cast<double>(truth.pixels()));
}

/// Two noisy halves of truth without features. sigma: standard deviation of the noise of a half.
inline HalfPair pair_of(const Image& truth, double sigma, std::uint64_t seed) {
  Random random(seed);
  const auto half = [&](int x, int y, int c) {
    return static_cast<double>(truth.at(x, y, c)) + sigma * random.normal();
  };
  HalfPair pair;
  for (Image& color : pair.color) color = image_of(truth.width(), truth.height(), truth.channels(), half);
  pair.variance = Image(truth.width(), truth.height(), 3, static_cast<Real>(sigma * sigma));
  for (Image& features : pair.features) features = Image(truth.width(), truth.height(), 0);
  pair.epsilon = 0.01;
  return pair;
}

}  // namespace polyrecon::test
