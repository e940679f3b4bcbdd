#include "noise/feature_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

constexpr int width = 96, height = 80;
constexpr double sigma = 0.1;

Image noisy(std::uint64_t seed) {
  test::Random random(seed);
  return test::image_of(width, height, 1,
                        [&](int x, int y, int) { return 0.3 + 0.002 * x - 0.001 * y + sigma * random.normal(); });
}

Image known_variance() { return Image(width, height, 1, Real(sigma * sigma)); }

double mean(const Image& image) { return test::sum_of(image, 0) / static_cast<double>(image.pixels()); }

/// r is 1 on the average with a standard deviation of some 0.16, and the part is above 0.99 from r = 0.78 on: nearly
/// all pixels, and of the others most.
TEST(NoiseInVariation, IsAllOfWhiteNoiseOnASlope) {
  EXPECT_GT(mean(noise_in_variation(noisy(1), known_variance())), 0.95);
}

TEST(NoiseInVariation, IsNothingOfTextureAboveItsNoise) {
  // The texture has 1 / 2 x (0.3)^2 = 4.5 times the variance of the noise: r = 0.18.
  Image texture = noisy(2);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) texture.at(x, y, 0) += Real(0.3 * std::sin(1.1 * x + 0.4 * y));
  EXPECT_LT(mean(noise_in_variation(texture, known_variance())), 0.001);
}

TEST(NoiseInVariation, WithoutNoiseThereIsNone) {
  const Image edge = test::image_of(width, height, 1, [](int x, int, int) { return x < 40; });
  const Image none(width, height, 1);
  EXPECT_TRUE(test::same_bits(noise_in_variation(edge, none), none));
  EXPECT_TRUE(test::same_bits(noise_in_variation(Image(width, height, 1, Real(2)), known_variance()), none));
}

/// Noise that grows from left to right over a texture: from texture alone to noise alone.
TEST(NoiseInVariation, RisesGradually) {
  test::Random random(3);
  const auto deviation = [](int x) { return 0.2 * x / width; };
  const Image image = test::image_of(width, height, 1, [&](int x, int y, int) {
    return 0.05 * std::sin(1.1 * x + 0.4 * y) + deviation(x) * random.normal();
  });
  const Image part = noise_in_variation(
      image, test::image_of(width, height, 1, [&](int x, int, int) { return deviation(x) * deviation(x); }));
  const auto column = [&](int x) {
    double sum = 0;
    for (int y = 0; y < height; ++y) sum += static_cast<double>(part.at(x, y, 0)) / height;
    return sum;
  };
  for (int x = 1; x < width; ++x) EXPECT_LT(std::abs(column(x) - column(x - 1)), 0.15) << x;
  EXPECT_LT(column(8), 0.01);
  EXPECT_GT(column(width - 8), 0.95);
}

TEST(NoiseInVariation, OutsideThePictureIsNone) {
  const Image picture = test::image_of(width, height, 1, [](int x, int, int) { return x < 40; });
  Image image = noisy(4);
  for (int y = 0; y < height; ++y)
    for (int x = 40; x < width; ++x) image.at(x, y, 0) = Real(1000);
  const Image part = noise_in_variation(image, known_variance(), picture);
  for (int y = 0; y < height; ++y) EXPECT_EQ(part.at(60, y, 0), 0);
  EXPECT_GT(part.at(39, 40, 0), 0.5);  // what is outside does not count as variation
}

/// The blur leaves sum g^2 of the noise's variance: 1 / (4 pi 2.5^2) = 0.0127.
TEST(Flattened, TakesTheBlurWhereAllIsNoise) {
  const Image image = noisy(5), all(width, height, 1, Real(1)), none(width, height, 1);
  EXPECT_TRUE(test::same_bits(flattened(image, none), image));
  const Image flat = flattened(image, all);
  double square = 0;
  for (int y = 10; y < height - 10; ++y)
    for (int x = 10; x < width - 10; ++x) {
      const double error = static_cast<double>(flat.at(x, y, 0)) - (0.3 + 0.002 * x - 0.001 * y);
      square += error * error / ((width - 20) * (height - 20));
    }
  EXPECT_NEAR(square / (sigma * sigma), 0.0127, 0.004);
  const Image half = flattened(image, Image(width, height, 1, Real(0.5)));
  EXPECT_NEAR(half.at(50, 40, 0),
              0.5 * (static_cast<double>(image.at(50, 40, 0)) + static_cast<double>(flat.at(50, 40, 0))), 1e-6);
}

}  // namespace
}  // namespace polyrecon
