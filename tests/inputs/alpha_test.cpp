// Alpha that is denoised with the windows of the beauty, which may not know its edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/reconstruction.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

constexpr int width = 72, height = 50, samples = 16;

/// The coverage of a disc whose rim is `blur` pixels wide.
double disc(int x, int y, double blur) { return std::clamp(0.5 - (std::hypot(x - 36, y - 25) - 15) / blur, 0.0, 1.0); }

/// The share of the samples that hit the disc.
Image seen_by_samples(double blur) {
  test::Random random(7);
  return test::image_of(width, height, 1, [&](int x, int y, int) {
    int hits = 0;
    for (int s = 0; s < samples; ++s) hits += random.uniform() < disc(x, y, blur) ? 1 : 0;
    return static_cast<double>(hits) / samples;
  });
}

double squared_error(const Image& alpha, double blur) {
  double sum = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) sum += std::pow(static_cast<double>(alpha.at(x, y, 0)) - disc(x, y, blur), 2);
  return sum;
}

Image denoised(const Image& alpha, bool with_features) {
  test::Scene scene = test::make_scene(width, height, 0.3, 5);
  scene.frame.alpha = alpha;
  if (!with_features) scene.frame.features.clear();
  Params params = test::quick();
  params.reconstruct_alpha = true;
  return test::run(scene.frame, params).alpha;
}

TEST(DenoisedAlpha, HardEdgesThatNoFeatureShowsGetNoWorse) {
  const Image alpha = seen_by_samples(1.5);
  for (const bool with_features : {false, true})
    EXPECT_LE(squared_error(denoised(alpha, with_features), 1.5), squared_error(alpha, 1.5));
}

TEST(DenoisedAlpha, SoftNoisyEdgesGetBetter) {
  const Image alpha = seen_by_samples(24);
  EXPECT_LT(squared_error(denoised(alpha, false), 24), 0.5 * squared_error(alpha, 24));
}

TEST(DenoisedAlpha, WithoutNoiseStaysAsItIs) {
  const Image alpha = test::image_of(width, height, 1, [](int x, int y, int) { return disc(x, y, 4); });
  EXPECT_LT(test::max_difference(denoised(alpha, false), alpha), 0.02);
}

}  // namespace
}  // namespace polyrecon
