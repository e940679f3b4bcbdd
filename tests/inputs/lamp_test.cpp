// Lamps that no feature shows, and suns of a single pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/lamps.h"
#include "support/images.h"
#include "support/reconstruction.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

constexpr int width = 72, height = 50, samples = 16;
constexpr double center_x = 36.3, center_y = 25.2;

double distance(int x, int y) { return std::hypot(x - center_x, y - center_y); }

/// A single render in which samples of a disc hit a lamp.
test::Scene scene_with_lamp(double radiance, double radius) {
  test::Scene scene = test::make_scene(width, height, 0.3, 5);
  Pass& beauty = scene.frame.beauty;
  beauty.variance = beauty.half_a = beauty.half_b = Image();
  test::Random random(7);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double covered = std::clamp(radius + 0.5 - distance(x, y), 0.0, 1.0);
      int hits = 0;
      for (int s = 0; s < samples; ++s) hits += random.uniform() < covered ? 1 : 0;
      const double seen = static_cast<double>(hits) / samples;
      for (int c = 0; c < 3; ++c) {
        Real &noisy = beauty.mean.at(x, y, c), &truth = scene.truth.at(x, y, c);
        noisy = static_cast<Real>(seen * radiance + (1 - seen) * static_cast<double>(noisy));
        truth = static_cast<Real>(covered * radiance + (1 - covered) * static_cast<double>(truth));
      }
    }
  return scene;
}

/// Mean relative squared error of the pixels whose distance from the lamp's centre is in this range.
double error_between(const Image& image, const Image& truth, double nearest, double farthest) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (distance(x, y) < nearest || distance(x, y) > farthest) continue;
      for (int c = 0; c < 3; ++c) {
        const auto t = static_cast<double>(truth.at(x, y, c)), d = static_cast<double>(image.at(x, y, c)) - t;
        sum += d * d / (t * t + 0.01);
        ++count;
      }
    }
  return sum / count;
}

TEST(Lamp, StaysAsItIsAndLeavesItsSurroundingsAlone) {
  const test::Scene plain = scene_with_lamp(0, 0);
  const double without = error_between(test::run(plain.frame, test::quick()).beauty, plain.truth, 6, 16);
  for (const double radiance : {200.0, 3e3, 65504.0, 1e6}) {
    const test::Scene scene = scene_with_lamp(radiance, 4);
    const Image result = test::run(scene.frame, test::quick()).beauty;
    EXPECT_LT(error_between(result, scene.truth, 6, 16), 1.5 * without) << radiance;
    EXPECT_EQ(error_between(result, scene.truth, 0, 3), 0) << radiance;
    EXPECT_LE(error_between(result, scene.truth, 3, 6),
              1.01 * error_between(scene.frame.beauty.mean, scene.truth, 3, 6))
        << radiance;
  }
}

TEST(Lamp, OfOnePixelIsNoFireflyWhereItHoldsMuchOfTheEnergy) {
  for (const double radiance : {1e5, 1e6}) {
    test::Scene scene = scene_with_lamp(0, 0);
    for (int c = 0; c < 3; ++c) scene.frame.beauty.mean.at(36, 25, c) = static_cast<Real>(radiance);
    const Image result = test::run(scene.frame, test::quick()).beauty;
    EXPECT_EQ(result.at(36, 25, 1), static_cast<Real>(radiance));
    EXPECT_LT(error_between(result, scene.truth, 2, 100), error_between(scene.frame.beauty.mean, scene.truth, 2, 100));
  }
}

TEST(Lamp, HasTheErrorOfItsNoise) {
  const test::Scene scene = scene_with_lamp(3e3, 4);
  Frame frame = scene.frame;
  frame.beauty.variance =
      test::image_of(width, height, 3, [](int x, int y, int) { return std::abs(distance(x, y) - 4) < 1 ? 1e4 : 1e-4; });
  const Lamps lamps = find_lamps(frame, {});
  const Result result = test::run(frame, test::quick());
  double mean = 0;
  for (const std::size_t i : lamps.pixels) {
    double relative = 0;
    for (int c = 0; c < 3; ++c) {
      const auto value = static_cast<double>(result.beauty.plane(c)[i]);
      EXPECT_EQ(result.error.mse.plane(c)[i], frame.beauty.variance.plane(c)[i]);
      relative += static_cast<double>(frame.beauty.variance.plane(c)[i]) / (value * value + 0.01) / 3;
    }
    EXPECT_NEAR(static_cast<double>(result.error.relative_mse.plane(0)[i]), relative, 1e-5 * relative);
    EXPECT_EQ(result.error.relative_noise.plane(0)[i], result.error.relative_mse.plane(0)[i]);
  }
  for (std::size_t i = 0; i < result.error.relative_mse.pixels(); ++i)
    mean += static_cast<double>(result.error.relative_mse.plane(0)[i]) / (width * height);
  EXPECT_NEAR(result.error.mean_relative_mse, mean, 1e-6 * mean);
}

TEST(Lamp, LayersKeepTheirSharesOfIt) {
  test::Scene scene = scene_with_lamp(3e3, 4);
  scene.frame.aovs.push_back({"half", scene.frame.beauty.mean, {}, {}, {}});
  Image& half = scene.frame.aovs.front().mean;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < half.pixels(); ++i) half.plane(c)[i] *= Real(0.5);
  const Result result = test::run(scene.frame, test::quick());
  EXPECT_EQ(result.aovs.front().at(36, 25, 0), Real(0.5) * result.beauty.at(36, 25, 0));
}

TEST(Lamp, IsNothingThatIsNoisyOrAsBrightAsOtherThings) {
  EXPECT_TRUE(find_lamps(scene_with_lamp(0, 0).frame, {}).empty());
  EXPECT_TRUE(find_lamps(scene_with_lamp(4, 6).frame, {}).empty());
  const Lamps lamps = find_lamps(scene_with_lamp(3e3, 4).frame, {});
  ASSERT_FALSE(lamps.empty());
  for (const std::size_t i : lamps.pixels)
    EXPECT_LT(distance(static_cast<int>(i % width), static_cast<int>(i / width)), 5);
}

}  // namespace
}  // namespace polyrecon
