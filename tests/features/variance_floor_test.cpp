#include "features/variance_floor.h"

#include <gtest/gtest.h>

#include "support/images.h"

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

TEST(FloorVariance, ASpikeLendsThreeTenthsOfTheMeanToItsNeighbours) {
  Image variance(9, 9, 1);
  variance.at(4, 4, 0) = 50;
  const Image out = floor_variance(variance);
  EXPECT_EQ(out.at(4, 4, 0), Real(50));
  EXPECT_NEAR(static_cast<double>(out.at(2, 3, 0)), 0.3 * 50 / 25, 1e-6);
  EXPECT_EQ(out.at(1, 4, 0), Real(0));
}

TEST(FloorVariance, WithoutNoiseItStaysZero) {
  EXPECT_EQ(test::max_magnitude(floor_variance(Image(5, 3, 3))), 0);
  EXPECT_EQ(floor_variance(Image(1, 1, 3, Real(2))).at(0, 0, 0), Real(2));
}

}  // namespace
}  // namespace polyrecon
