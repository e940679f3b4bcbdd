#include "core/resample.h"

#include <gtest/gtest.h>

#include "support/images.h"

namespace polyrecon {
namespace {

using test::image_of;

TEST(HalfResolution, IsTheMeanOfThePixelsThatAreThere) {
  // 3 x 3 of 3 y + x: the mean of {0, 1, 3, 4} is 2, of the last column {2, 5} 3.5, of the last row {6, 7} 6.5,
  // corner 8.
  const Image out = half_resolution(image_of(3, 3, 1, [](int x, int y, int) { return 3 * y + x; }));
  ASSERT_TRUE(out.same_shape(Image(2, 2, 1)));
  EXPECT_EQ(out.at(0, 0, 0), Real(2));
  EXPECT_EQ(out.at(1, 0, 0), Real(3.5));
  EXPECT_EQ(out.at(0, 1, 0), Real(6.5));
  EXPECT_EQ(out.at(1, 1, 0), Real(8));
}

TEST(HalfResolution, OfOnePixelIsThatPixel) {
  EXPECT_EQ(half_resolution(Image(1, 1, 1, Real(3))).at(0, 0, 0), Real(3));
}

TEST(DoubleResolution, IsBilinearBetweenTheCentresOfTheCoarsePixels) {
  // Coarse 0, 4 in a row: centres at fine 0.5 and 2.5, so the fine pixels 0, 1, 2, 3 are 0 (beyond), 1, 3, 4 (beyond).
  const Image out = double_resolution(image_of(2, 1, 1, [](int x, int, int) { return 4 * x; }), 4, 2);
  for (int y = 0; y < 2; ++y) {
    EXPECT_EQ(out.at(0, y, 0), Real(0));
    EXPECT_EQ(out.at(1, y, 0), Real(1));
    EXPECT_EQ(out.at(2, y, 0), Real(3));
    EXPECT_EQ(out.at(3, y, 0), Real(4));
  }
}

TEST(DoubleResolution, UndoesHalvingOfALinearImageAwayFromTheBorder) {
  const Image plane = image_of(10, 9, 2, [](int x, int y, int c) { return 3 * x - 2 * y + c; });
  const Image out = double_resolution(half_resolution(plane), 10, 9);
  for (int c = 0; c < 2; ++c)
    for (int y = 1; y < 7; ++y)
      for (int x = 1; x < 9; ++x)
        EXPECT_NEAR(static_cast<double>(out.at(x, y, c)), static_cast<double>(plane.at(x, y, c)), 1e-5);
}

}  // namespace
}  // namespace polyrecon
