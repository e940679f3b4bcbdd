#include "prior/sharpen.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/gaussian.h"
#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

using test::image_of;

constexpr int size = 64;
constexpr double epsilon = 0.01;

/// Discs and a grating: edges and detail.
Image sharp_image() {
  return image_of(size, size, 3, [](int x, int y, int c) {
    const bool disc = std::hypot(x % 20 - 10, y % 20 - 10) < 6;
    return (disc ? 1.5 : 0.2) + 0.1 * std::sin(1.3 * x + 0.1 * c) * std::cos(0.9 * y);
  });
}

Image with_noise(Image image, double sigma, std::uint64_t seed) {
  test::Random random(seed);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i) image.plane(c)[i] += static_cast<Real>(sigma * random.normal());
  return image;
}

double squared_distance(const Image& a, const Image& b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < a.pixels(); ++i)
      sum += std::pow(static_cast<double>(a.plane(c)[i]) - static_cast<double>(b.plane(c)[i]), 2);
  return sum;
}

TEST(SharpenTo, UndoesMostOfABlur) {
  const Image truth = sharp_image(), ours = with_noise(truth, 0.05, 1);
  for (const double sigma : {0.5, 0.7, 1.0}) {
    const Image blurred = gaussian_blur(truth, sigma);
    EXPECT_LT(squared_distance(sharpen_to(blurred, ours, epsilon), truth), 0.4 * squared_distance(blurred, truth))
        << sigma;
  }
}

TEST(SharpenTo, KeepsAPriorThatIsSharpEnough) {
  const Image truth = sharp_image();
  EXPECT_TRUE(test::same_bits(sharpen_to(truth, gaussian_blur(truth, 0.7), epsilon), truth));
  const Image noisy = with_noise(truth, 0.1, 2);
  EXPECT_TRUE(test::same_bits(sharpen_to(noisy, truth, epsilon), noisy));
}

/// Rounding must not decide whether a prior is sharpened.
TEST(SharpenTo, ASmallSlopeSharpensInProportion) {
  const Image truth = sharp_image(), prior = gaussian_blur(truth, 0.7);
  const auto part_undone = [&](double t) {  // of the squared difference in sharpness
    Image ours = prior;
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < ours.pixels(); ++i)
        ours.plane(c)[i] += static_cast<Real>(t) * (truth.plane(c)[i] - prior.plane(c)[i]);
    return squared_distance(sharpen_to(prior, ours, epsilon), prior) / squared_distance(ours, prior);
  };
  EXPECT_GT(part_undone(1), 0.5);
  EXPECT_LT(part_undone(0.01), 0.2 * part_undone(1));
}

TEST(SharpenTo, BrightnessIsNoSharpness) {
  const Image truth = sharp_image();
  Image darker = truth;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < truth.pixels(); ++i) darker.plane(c)[i] *= Real(0.5);
  EXPECT_LT(squared_distance(sharpen_to(darker, truth, epsilon), darker), 1e-6 * squared_distance(darker, truth));
}

TEST(SharpenTo, AnEvenImageStays) {
  const Image even(size, size, 3, Real(0.5));
  EXPECT_TRUE(test::same_bits(sharpen_to(even, sharp_image(), epsilon), even));
  const Image black(size, size, 3);
  EXPECT_TRUE(test::same_bits(sharpen_to(black, sharp_image(), epsilon), black));
}

TEST(SharpenTo, NothingBecomesNegative) {
  const Image ours = image_of(size, size, 3, [](int x, int y, int) { return (x / 8 + y / 8) % 2 ? 10.0 : 0.0; });
  const Image sharp = sharpen_to(gaussian_blur(ours, 1), ours, epsilon);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < sharp.pixels(); ++i) EXPECT_GE(sharp.plane(c)[i], 0);
}

}  // namespace
}  // namespace polyrecon
