#include "noise/variance_floor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

TEST(FloorVariance, AZeroAmongNoiseBecomesTheMedianAround) {
  Image variance = test::image_of(9, 9, 2, [](int x, int y, int c) { return 1 + 0.01 * (9 * y + x) + c; });
  variance.at(4, 4, 0) = 0;
  const Image out = floor_variance(variance);
  // 24 neighbours and the zero: the upper median of 25 is the 12th of the neighbours, (4 - 0, 4)'s left neighbour: x =
  // 3, y = 4.
  EXPECT_EQ(out.at(4, 4, 0), variance.at(3, 4, 0));
  EXPECT_EQ(out.at(4, 4, 1), variance.at(4, 4, 1));
}

TEST(FloorVariance, ASpikeLendsHalfTheSquareOfTheMeanDeviationToItsNeighbours) {
  Image variance(9, 9, 1);
  variance.at(4, 4, 0) = 50;
  const Image out = floor_variance(variance);
  EXPECT_EQ(out.at(4, 4, 0), Real(50));
  EXPECT_NEAR(static_cast<double>(out.at(2, 3, 0)), 0.5 * 50 / (25 * 25), 1e-6);
  EXPECT_EQ(out.at(1, 4, 0), Real(0));
}

TEST(FloorVariance, WithoutNoiseItStaysZero) {
  EXPECT_EQ(test::max_magnitude(floor_variance(Image(5, 3, 3))), 0);
  EXPECT_EQ(floor_variance(Image(1, 1, 3, Real(2))).at(0, 0, 0), Real(2));
}

TEST(FloorVariance, TransposesWithTheImage) {
  test::Random random(1);
  const Image variance =
      test::image_of(19, 13, 1, [&](int, int, int) { return random.uniform() < 0.5 ? 0 : random.uniform(); });
  const auto transposed = [](const Image& image) {
    return test::image_of(image.height(), image.width(), 1, [&](int x, int y, int) { return image.at(y, x, 0); });
  };
  EXPECT_LT(test::max_difference(floor_variance(transposed(variance)), transposed(floor_variance(variance))), 1e-6);
}

/// The median of medians is used in place of the median: over noise of any kind their means agree to a few percent.
TEST(FloorVariance, IsAboutTheMedianOfTheNeighbourhood) {
  test::Random random(2);
  const Image variance = test::image_of(64, 64, 1, [&](int, int, int) { return std::exp(random.normal()); });
  // The floor is the result where the pixel itself is 0. Pixels are set to 0 on a lattice whose neighbourhoods do not
  // overlap.
  Image holes = variance;
  double expected = 0, found = 0;
  for (int y = 2; y < 62; y += 5)
    for (int x = 2; x < 62; x += 5) holes.at(x, y, 0) = 0;
  const Image out = floor_variance(holes);
  for (int y = 2; y < 62; y += 5)
    for (int x = 2; x < 62; x += 5) {
      std::vector<Real> around;
      double mean_deviation = 0;
      for (int v = y - 2; v <= y + 2; ++v)
        for (int u = x - 2; u <= x + 2; ++u) {
          around.push_back(holes.at(u, v, 0));
          mean_deviation += std::sqrt(static_cast<double>(holes.at(u, v, 0))) / 25;
        }
      std::nth_element(around.begin(), around.begin() + 12, around.end());
      expected += std::max(static_cast<double>(around[12]), 0.5 * mean_deviation * mean_deviation);
      found += static_cast<double>(out.at(x, y, 0));
    }
  EXPECT_NEAR(found / expected, 1, 0.05);
}

}  // namespace
}  // namespace polyrecon
