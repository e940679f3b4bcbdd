#include "core/gaussian.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/images.h"

namespace polyrecon {
namespace {

TEST(GaussianBlur, KeepsAConstantUpToTheBorder) {
  for (const double sigma : {0.5, 1.5, 4.0}) {
    const Image out = gaussian_blur(Image(7, 3, 2, Real(2.5)), sigma);
    EXPECT_LE(test::max_difference(out, Image(7, 3, 2, Real(2.5))), 1e-6) << sigma;
  }
}

TEST(GaussianBlur, AnImpulseBecomesTheProductOfTwoNormalisedGaussians) {
  const double sigma = 1.5;
  // The image is large enough for the kernel not to touch the border.
  const int radius = gaussian_radius(sigma), size = 4 * radius + 1, middle = size / 2;
  EXPECT_EQ(radius, 5);  // ceil(4.5)
  Image impulse(size, size, 1);
  impulse.at(middle, middle, 0) = 1;
  const Image out = gaussian_blur(impulse, sigma);
  double norm = 0;
  for (int k = -radius; k <= radius; ++k) norm += std::exp(-k * k / (2 * sigma * sigma));
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const int dx = x - middle, dy = y - middle;
      const bool inside = std::abs(dx) <= radius && std::abs(dy) <= radius;
      const double expected = inside ? std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)) / (norm * norm) : 0;
      EXPECT_NEAR(static_cast<double>(out.at(x, y, 0)), expected, 1e-7) << dx << " " << dy;
    }
}

TEST(GaussianBlur, AtTheBorderItIsTheMeanOfTheTapsInside) {
  // 1 x 3, sigma 1: taps t = exp(-1/2), u = exp(-2) around a centre of 1.
  const Image in = test::image_of(3, 1, 1, [](int x, int, int) { return x == 0 ? 1 : 0; });
  const double t = std::exp(-0.5), u = std::exp(-2.0);
  const Image out = gaussian_blur(in, 1);
  EXPECT_NEAR(static_cast<double>(out.at(0, 0, 0)), 1 / (1 + t + u), 1e-7);
  EXPECT_NEAR(static_cast<double>(out.at(1, 0, 0)), t / (1 + 2 * t), 1e-7);
  EXPECT_NEAR(static_cast<double>(out.at(2, 0, 0)), u / (1 + t + u), 1e-7);
}

}  // namespace
}  // namespace polyrecon
