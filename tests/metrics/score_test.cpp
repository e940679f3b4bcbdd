#include "polyrecon/score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

TEST(Score, AgreesWithFiguresWorkedOutByHand) {
  // Two pixels of three channels, reference 1 everywhere, its variance 0.01; image 1.1 in all channels of the first
  // pixel and 1 in the second. ((0.1)^2 - 0.01) / 1.01 = 0 for the first, (0 - 0.01) / 1.01 for the second: mean
  // -0.0049505. Energy: (1.1 + 1) / 2 / 1 - 1 = 0.05. Trimmed keeps floor(2 * 0.999) = 1 pixel, the lower one:
  // -0.0099010.
  Image image(2, 1, 3, 1), reference(2, 1, 3, 1), variance(2, 1, 3, static_cast<Real>(0.01));
  for (int c = 0; c < 3; ++c) image.at(0, 0, c) = static_cast<Real>(1.1);
  const Score s = score(image, reference, variance);
  EXPECT_NEAR(s.relative_mse, -0.0049505, 1e-7);
  EXPECT_NEAR(s.trimmed, -0.0099010, 1e-7);
  EXPECT_NEAR(s.energy, 0.05, 1e-7);
  EXPECT_EQ(s.bad, 0u);
}

TEST(Score, WithoutVarianceTheWholeSquareCounts) {
  // One channel, reference 0 and 2: (0.3^2) / 0.01 = 9 and (1^2) / 4.01 = 0.249377; mean 4.624688.
  Image image(2, 1, 1), reference(2, 1, 1);
  image.at(0, 0, 0) = static_cast<Real>(0.3);
  image.at(1, 0, 0) = 3;
  reference.at(1, 0, 0) = 2;
  EXPECT_NEAR(score(image, reference, {}).relative_mse, 4.624688, 1e-5);
}

TEST(Score, BadPixelsAreCountedOnceAndTakenAsBlack) {
  Image image(2, 1, 3, 1), reference(2, 1, 3, 1);
  image.at(1, 0, 0) = std::numeric_limits<Real>::quiet_NaN();
  image.at(1, 0, 2) = std::numeric_limits<Real>::infinity();
  const Score s = score(image, reference, {});
  EXPECT_EQ(s.bad, 1u);
  // Two of six samples are 0 in place of 1: 2/6 of 1/1.01, and 1/3 of the energy is gone.
  EXPECT_NEAR(s.relative_mse, 2.0 / 6 / 1.01, 1e-9);
  EXPECT_NEAR(s.energy, -1.0 / 3, 1e-9);
}

TEST(Score, OnePixelHasNoTrimmedMean) {
  const Score s = score(Image(1, 1, 3, 1), Image(1, 1, 3, 1), {});
  EXPECT_EQ(s.relative_mse, 0);
  EXPECT_TRUE(std::isnan(s.trimmed));
}

TEST(RelativeError, IsTheMeanOverChannelsOfEachPixel) {
  Image image(2, 1, 3, 2), reference(2, 1, 3, 2);
  image.at(1, 0, 0) = 3;  // (3 - 2)^2 / (4 + 0.01) in one of three channels
  const Image error = relative_error(image, reference);
  EXPECT_EQ(error.channels(), 1);
  EXPECT_EQ(error.at(0, 0, 0), 0);
  EXPECT_NEAR(error.at(1, 0, 0), 1 / 4.01 / 3, 1e-7);
}

TEST(Score, OtherSizesAreRefused) { EXPECT_THROW(score(Image(2, 1, 3), Image(1, 2, 3), {}), Error); }

}  // namespace
}  // namespace polyrecon
