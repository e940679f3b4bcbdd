#include "core/repair.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/images.h"

namespace polyrecon {
namespace {

constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();
constexpr Real infinity = std::numeric_limits<Real>::infinity();

TEST(Usable, RefusesWhatCannotBeComputedWith) {
  for (const Real v : {nan, infinity, -infinity, Real(1e30), Real(-1e30)}) EXPECT_FALSE(usable(v)) << v;
  for (const Real v : {Real(0), Real(-1), Real(1e10), std::numeric_limits<Real>::denorm_min(), largest_value})
    EXPECT_TRUE(usable(v)) << v;
}

TEST(HasUsablePixel, AsksForAllChannelsOfOnePixel) {
  Image image(3, 1, 3, Real(1));
  image.at(0, 0, 0) = nan;
  image.at(1, 0, 2) = infinity;
  EXPECT_TRUE(has_usable_pixel(image));
  image.at(2, 0, 1) = Real(-1e30);
  EXPECT_FALSE(has_usable_pixel(image));
  EXPECT_FALSE(has_usable_pixel(Image()));
}

TEST(RepairNonfinite, GivesAHoleTheMeanOfItsGoodNeighbours) {
  // 3 x 3 of 3 y + x without its middle: the mean of the other eight is (36 - 4) / 8 = 4. All channels of a bad pixel
  // are replaced.
  Image image = test::image_of(3, 3, 2, [](int x, int y, int c) { return 3 * y + x + 10 * c; });
  image.at(1, 1, 0) = nan;
  EXPECT_EQ(repair_nonfinite(image, 1), 1u);
  EXPECT_EQ(image.at(1, 1, 0), Real(4));
  EXPECT_EQ(image.at(1, 1, 1), Real(14));
}

TEST(RepairNonfinite, GrowsInwardsRingByRingAndStopsAtItsDepth) {
  // A row of 6, a hole of 5 pixels, 2: each of two rings repairs one pixel at both ends, so the middle one becomes 0.
  Image row(7, 1, 1, nan);
  row.at(0, 0, 0) = 6;
  row.at(6, 0, 0) = 2;
  EXPECT_EQ(repair_nonfinite(row, 2), 5u);
  const double expected[] = {6, 6, 6, 0, 2, 2, 2};
  for (int x = 0; x < 7; ++x) EXPECT_EQ(static_cast<double>(row.at(x, 0, 0)), expected[x]) << x;
}

TEST(RepairNonfinite, AnImageWithoutAGoodPixelBecomesBlack) {
  Image image(4, 3, 3, infinity);
  EXPECT_EQ(repair_nonfinite(image, 8), 12u);
  EXPECT_EQ(test::max_magnitude(image), 0);
}

TEST(RepairNonfinite, KeepsAGoodImage) {
  Image image = test::image_of(4, 3, 1, [](int x, int y, int) { return x - y; });
  const Image before = image;
  EXPECT_EQ(repair_nonfinite(image, 8), 0u);
  EXPECT_TRUE(test::same_bits(image, before));
}

}  // namespace
}  // namespace polyrecon
