#include "blend/undershoot.h"

#include <gtest/gtest.h>

#include "support/images.h"

namespace polyrecon {
namespace {

using test::image_of;

TEST(RaiseUndershoot, LiftsAValueToTheLeastInputAroundIt) {
  const Image input = image_of(9, 7, 3, [](int x, int y, int c) { return 1 + 0.1 * x + 0.01 * y + c; });
  Image image = input;
  image.at(4, 3, 1) = -5;
  EXPECT_EQ(raise_undershoot(input, image), 1u);
  EXPECT_EQ(image.at(4, 3, 1), input.at(2, 1, 1));  // the least of 5 x 5 pixels is the one up and to the left
  image.at(4, 3, 1) = input.at(4, 3, 1);
  EXPECT_TRUE(test::same_bits(image, input));
}

TEST(RaiseUndershoot, LeavesWhatIsNotBelowAllInputs) {
  const Image input = image_of(9, 7, 3, [](int x, int, int) { return x; });
  Image image = image_of(9, 7, 3, [](int x, int, int) { return x - 1.5; });
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 7; ++y) image.at(0, y, c) = image.at(1, y, c) = 0;  // the least input there is 0
  const Image before = image;
  EXPECT_EQ(raise_undershoot(input, image), 0u);
  EXPECT_TRUE(test::same_bits(image, before));
}

TEST(RaiseUndershoot, CountsAPixelOnce) {
  const Image input(5, 5, 3, Real(1));
  Image image(5, 5, 3, Real(2));
  for (int c = 0; c < 3; ++c) image.at(2, 2, c) = 0;
  EXPECT_EQ(raise_undershoot(input, image), 1u);
}

TEST(RaiseUndershoot, LayersThatAddUpStillDo) {
  const auto layered = [](const auto& beauty) {
    return image_of(8, 8, 10, [&](int x, int y, int c) {
      const double share = 0.25 + 0.5 * (x % 2);
      return c == 9 ? 0.5 : beauty(x, y) * (c < 3 ? 1 : c < 6 ? share : 1 - share);
    });
  };
  const Image input = layered([](int x, int y) { return 1 + 0.1 * x + 0.2 * y; });
  Image image = layered([](int x, int y) { return x == 3 && y == 3 ? -1 : 9; });
  EXPECT_EQ(raise_undershoot(input, image), 1u);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(static_cast<double>(image.at(3, 3, 3 + c)) + static_cast<double>(image.at(3, 3, 6 + c)),
                static_cast<double>(image.at(3, 3, c)), 1e-6);
  EXPECT_EQ(image.at(3, 3, 9), Real(0.5));
}

/// A layer that is no part of the beauty, such as an albedo, may be a thousand times brighter than a dark corner.
TEST(RaiseUndershoot, ALayerThatIsNoPartOfTheBeautyIsNotTornAlong) {
  const Image input = image_of(8, 8, 6, [](int, int, int c) { return c < 3 ? 0.001 : 1; });
  Image image = input;
  image.at(3, 3, 0) = Real(-0.5);
  raise_undershoot(input, image);
  EXPECT_NEAR(static_cast<double>(image.at(3, 3, 0)), 0.001, 1e-6);
  EXPECT_LE(image.at(3, 3, 3), Real(1.6));  // at most by what the beauty was raised by, not 500 times as much
}

}  // namespace
}  // namespace polyrecon
