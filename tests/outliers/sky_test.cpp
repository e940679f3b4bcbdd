#include "outliers/sky.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/mask.h"
#include "outliers/remove.h"
#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

constexpr int size = 24;

/// A ground below a sky of the given albedo, with a star at (12, 5).
Frame night(double albedo_of_sky, double albedo_of_star) {
  test::Random random(7);
  Frame frame;
  frame.beauty.mean = test::image_of(size, size, 3, [&](int x, int y, int) {
    return (x == 12 && y == 5) ? 5 : y > 15 ? 0.3 + 0.05 * random.normal() : 0.004;
  });
  frame.features.resize(2);
  frame.features[0].role = Role::Normal;
  frame.features[0].pass.mean = test::image_of(size, size, 3, [](int, int y, int c) { return y > 15 && c == 1; });
  frame.features[1].role = Role::Albedo;
  frame.features[1].pass.mean = test::image_of(size, size, 3, [&](int x, int y, int) {
    return (x == 12 && y == 5) ? albedo_of_star : y > 15 ? 0.5 : albedo_of_sky;
  });
  return frame;
}

bool may_be_firefly(const Frame& frame, int x, int y) {
  const Image mask = firefly_mask(frame);
  return in_mask(mask, frame.beauty.mean.index(x, y));
}

TEST(FireflyMask, LeavesOutStars) {
  EXPECT_FALSE(may_be_firefly(night(0, 0), 12, 5));
  EXPECT_FALSE(may_be_firefly(night(0.004, 1), 12, 5));
}

TEST(FireflyMask, HoldsSurfacesWhateverTheirAlbedo) {
  Frame frame = night(0, 0);
  EXPECT_TRUE(may_be_firefly(frame, 12, 20));
  for (int c = 0; c < 3; ++c) frame.features[1].pass.mean.at(12, 20, c) = Real(2);
  EXPECT_TRUE(may_be_firefly(frame, 12, 20));
  frame.features[0].pass.mean.at(12, 5, 0) = Real(0.1);  // a sample hit something
  EXPECT_TRUE(may_be_firefly(frame, 12, 5));
}

/// A volume has an albedo and no normal.
TEST(FireflyMask, HoldsVolumesBeforeTheSky) { EXPECT_TRUE(may_be_firefly(night(0.8, 0.8), 12, 5)); }

TEST(FireflyMask, IsEmptyWithoutNormalOrAlbedo) {
  for (const std::size_t missing : {0, 1}) {
    Frame frame = night(0, 0);
    frame.features.erase(frame.features.begin() + static_cast<std::ptrdiff_t>(missing));
    EXPECT_TRUE(firefly_mask(frame).empty());
  }
  EXPECT_TRUE(firefly_mask(night(0.8, 0.8)).empty());
}

TEST(FireflyMask, ValuesThatAreNotFiniteAreNoSky) {
  Frame frame = night(0.004, 1);
  frame.features[1].pass.mean.at(11, 5, 0) = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_TRUE(may_be_firefly(frame, 12, 5));
}

TEST(FireflyMask, KeepsStarsThatWouldBeRemoved) {
  const Frame frame = night(0, 0);
  const auto remove = [&](const Image& mask) {
    HalfPair pair;
    pair.color = {frame.beauty.mean, frame.beauty.mean};
    pair.variance = Image(size, size, 3, Real(0.0025));
    return remove_outliers(pair, {false, false}, OutlierParams{}, silent_progress(), mask).size();
  };
  EXPECT_EQ(remove({}), 2u);
  EXPECT_EQ(remove(firefly_mask(frame)), 0u);
}

}  // namespace
}  // namespace polyrecon
