#include "noise/edge_variance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

constexpr int width = 96, height = 80;
constexpr double sigma = 0.1;

template <typename Signal>
Image noisy(const Signal& signal, double deviation, std::uint64_t seed) {
  test::Random random(seed);
  return test::image_of(width, height, 3,
                        [&](int x, int y, int c) { return signal(x, y) + (c + 1) * deviation * random.normal(); });
}

double mean(const Image& image, int c) { return test::sum_of(image, c) / static_cast<double>(image.pixels()); }

Image counts(double n) { return Image(width, height, 1, static_cast<Real>(n)); }

/// 7 x 7 places of the kernel have some 20 degrees of freedom, and the median of 25 such means is 3 % below the mean.
TEST(CornerVariance, IsThatOfWhiteNoiseOnASmoothPicture) {
  const Image y = noisy([](int x, int v) { return 1 + 0.02 * x + 0.0003 * x * v + std::sin(0.2 * v); }, sigma, 1);
  const Image out = corner_variance(y);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean(out, c) / std::pow((c + 1) * sigma, 2), 0.97, 0.05);
}

/// A band-limited texture: four pixels to a wave leave (2 (1 - cos w))^3 / 20 = 8 / 20 of an axis, six 1 / 20.
TEST(CornerVariance, HardlySeesATextureOfLowerFrequencies) {
  const Image y =
      test::image_of(width, height, 1, [](int x, int v, int) { return std::sin(1.05 * x) * std::sin(1.05 * v); });
  EXPECT_LT(mean(corner_variance(y), 0), 0.25 / 200);
}

TEST(CornerVariance, DoesNotReachAcrossTheBorderOfThePicture) {
  const Image picture = test::image_of(width, height, 1, [](int x, int, int) { return x < 48; });
  Image y = noisy([](int, int) { return 1; }, sigma, 2);
  for (int v = 0; v < height; ++v)
    for (int x = 48; x < width; ++x) y.at(x, v, 0) = Real(1000);
  const Image out = corner_variance(y, picture);
  for (int v = 0; v < height; ++v) {
    EXPECT_LT(out.at(47, v, 0), 4 * sigma * sigma);
    EXPECT_EQ(out.at(80, v, 0), 0);
  }
}

TEST(CornerVariance, OfTinyPicturesIsZero) {
  for (const int n : {1, 3}) EXPECT_TRUE(test::same_bits(corner_variance(Image(n, 9, 3, Real(2))), Image(n, 9, 3)));
}

/// At n = 4 samples count as independent: a pixel of 4 between 1 and 9 has (9 - 4)(4 - 1) / 4.
TEST(TwoValueVariance, IsTheBoundOfBhatiaAndDavis) {
  Image y(width, height, 1, Real(1));
  for (int v = 0; v < height; ++v) {
    y.at(40, v, 0) = Real(4);
    for (int x = 41; x < width; ++x) y.at(x, v, 0) = Real(9);
  }
  const Image few = two_value_variance(y, counts(4)), many = two_value_variance(y, counts(64));
  EXPECT_FLOAT_EQ(few.at(40, 30, 0), 5 * 3 / 4.0f);
  EXPECT_FLOAT_EQ(many.at(40, 30, 0), 5 * 3 / 64.0f * 4 / 8);  // stratified
  EXPECT_EQ(few.at(39, 30, 0), 0);
  EXPECT_EQ(few.at(60, 30, 0), 0);
  EXPECT_TRUE(test::same_bits(two_value_variance(y, counts(0)), Image(width, height, 1)));
}

/// The mean of n stratified samples of a pixel that a straight rim between 0 and `bright` crosses.
double rim_pixel(int x, int y, int n, double bright, test::Random& random) {
  const int side = static_cast<int>(std::lround(std::sqrt(n)));
  int hits = 0;
  for (int k = 0; k < n; ++k) {
    const double u = x + (k % side + random.uniform()) / side, v = y + (k / side + random.uniform()) / side;
    hits += u + 0.37 * v > 60;
  }
  return bright * hits / n;
}

/// The rim of a lamp, 40 times as bright as the rest. Its pixels' true variance is that of many renders.
TEST(EdgeVariance, OfALampsRimIsOfTheSizeOfTheNoise) {
  for (const int n : {16, 64}) {
    test::Random random(3);
    const auto render = [&] {
      return test::image_of(width, height, 1, [&](int x, int y, int) { return 1 + rim_pixel(x, y, n, 40, random); });
    };
    constexpr int renders = 24;
    Image sum(width, height, 1), squares(width, height, 1);
    double estimated = 0;
    for (int k = 0; k < renders; ++k) {
      const Image y = render(), edge = edge_variance(y, counts(n));
      for (std::size_t i = 0; i < y.pixels(); ++i) {
        sum.plane(0)[i] += y.plane(0)[i] / renders;
        squares.plane(0)[i] += y.plane(0)[i] * y.plane(0)[i] / renders;
        estimated += static_cast<double>(edge.plane(0)[i]) / renders;
      }
    }
    double truth = 0;
    for (std::size_t i = 0; i < sum.pixels(); ++i)
      truth += static_cast<double>(squares.plane(0)[i] - sum.plane(0)[i] * sum.plane(0)[i]);
    EXPECT_GT(estimated / truth, 0.5) << n;
    EXPECT_LT(estimated / truth, 4) << n;
  }
}

/// Lines of one pixel without noise alias, so the corner shows them; two values seen by many samples hardly vary.
TEST(EdgeVariance, OfAliasedLinesIsThatOfTheirSamples) {
  const Image y = test::image_of(width, height, 1, [](int x, int, int) { return x % 7 == 0 ? 2 : 1; });
  EXPECT_TRUE(test::same_bits(edge_variance(y, counts(16)), Image(width, height, 1)));
  const Image specks = noisy([](int x, int v) { return (x * 7 + v * 13) % 5; }, 0, 5);
  const Image edge = edge_variance(specks, counts(1024)), corner = corner_variance(specks);
  EXPECT_LT(mean(edge, 0), 0.01 * mean(corner, 0));
}

}  // namespace
}  // namespace polyrecon
