// The figures that pages show in addition to scores: worst pixels, reliability of an error map, flicker.

#include <gtest/gtest.h>

#include <limits>

#include "metrics/flicker.h"
#include "metrics/reliability.h"
#include "metrics/worst_pixels.h"

namespace polyrecon {
namespace {

constexpr Real nan_value = std::numeric_limits<Real>::quiet_NaN();

TEST(WorstPixels, AreApartAndOrdered) {
  Image values(40, 20, 1);
  values.at(5, 5, 0) = 9;
  values.at(7, 6, 0) = 8;  // within three pixels of a larger one
  values.at(30, 2, 0) = 7;
  values.at(20, 19, 0) = 1;
  values.at(0, 0, 0) = nan_value;
  const auto found = worst_pixels(values, 10, 3);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].x, 5);
  EXPECT_EQ(found[1].x, 30);
  EXPECT_EQ(found[2].y, 19);
  EXPECT_EQ(found[2].value, 1);
  EXPECT_EQ(worst_pixels(values, 1, 3).size(), 1u);
}

TEST(Reliability, OfAnEstimateThatIsHalfTheTruth) {
  const int width = 100;
  Image estimated(width, 1, 1), image(width, 1, 3), reference(width, 1, 3, 1);
  for (int x = 0; x < width; ++x) {
    const double error = 1e-4 * (1 + x);  // of the reference, whose square and the floor are 1.01
    estimated.at(x, 0, 0) = static_cast<Real>(error * error / 1.01 / 2);
    for (int c = 0; c < 3; ++c) image.at(x, 0, c) = static_cast<Real>(1 + error);
  }
  image.at(3, 0, 1) = nan_value;
  const auto deciles = reliability(estimated, image, reference, {});
  ASSERT_EQ(deciles.size(), 10u);
  for (const ReliabilityDecile& decile : deciles) EXPECT_NEAR(decile.measured / decile.estimated, 2, 0.01);
  const Image variance(width, 1, 3, Real(1e-9));
  EXPECT_NEAR(reliability(estimated, image, reference, variance)[0].measured, deciles[0].measured - 1e-9 / 1.01, 1e-11);
}

TEST(Flicker, IsTheVarianceOfIndependentErrors) {
  const Image none;
  Image reference(4, 1, 1, 2), before(4, 1, 1, 2), now(4, 1, 1, 2);
  EXPECT_EQ(flicker({now, reference, none}, {before, reference, none}), 0);
  const Image brighter(4, 1, 1, 3);  // a change that the reference has, too, is no flicker
  EXPECT_EQ(flicker({brighter, brighter, none}, {before, reference, none}), 0);
  for (int x = 0; x < 4; ++x) now.at(x, 0, 0) += x % 2 == 0 ? Real(0.5) : Real(-0.5);
  EXPECT_NEAR(flicker({now, reference, none}, {before, reference, none}), 0.25 / 4.01 / 2, 1e-7);
  const Image variance(4, 1, 1, Real(0.01));
  EXPECT_NEAR(flicker({now, reference, variance}, {before, reference, none}), (0.25 - 0.01) / 4.01 / 2, 1e-7);
  now.at(1, 0, 0) = nan_value;
  EXPECT_NEAR(flicker({now, reference, none}, {before, reference, none}), 0.25 / 4.01 / 2, 1e-7);
}

}  // namespace
}  // namespace polyrecon
