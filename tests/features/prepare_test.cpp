#include "features/prepare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "polyrecon/error.h"
#include "regression/basis.h"
#include "support/images.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

using test::image_of;
using test::make_scene;

constexpr int width = 32, height = 24;
constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();

Prepared prepared(const Frame& frame, bool with_alpha = true) {
  Frame taken = frame;
  return prepare(taken, choose_features(frame), frame.beauty.variance, PrefilterParams{}, with_alpha,
                 silent_progress());
}

/// The reason for which the only feature of the scene was dropped; empty if it was not.
std::string reason_of(const Image& mean, Role kind, const Image& variance = {}) {
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  frame.features = {{kind, {"f", mean, variance, {}, {}}}};
  const Preparation out = choose_features(frame);
  EXPECT_EQ(out.features.empty(), !out.decisions.front().run);
  return out.features.empty() ? out.decisions.front().reason : "";
}

TEST(LookAt, DropsFeaturesThatSayNothing) {
  EXPECT_EQ(reason_of(Image(width, height, 3, Real(0.5)), Role::Albedo), "constant");
  EXPECT_EQ(reason_of(Image(width, height, 1), Role::Visibility), "constant");
  EXPECT_EQ(reason_of(Image(width, height, 3, nan), Role::Normal), "no finite value");
  EXPECT_EQ(reason_of(Image(width, height, 1, Real(1e10)), Role::Depth), "no finite value");  // all sky
  test::Random random(2);
  const Image noise = image_of(width, height, 1, [&](int, int, int) { return random.normal(); });
  EXPECT_EQ(reason_of(noise, Role::Visibility, Image(width, height, 1, Real(1))), "nothing but noise");
}

TEST(LookAt, KeepsFeaturesThatVary) {
  const Image ramp = image_of(width, height, 1, [](int x, int, int) { return x; });
  EXPECT_EQ(reason_of(ramp, Role::Visibility), "");
  EXPECT_EQ(reason_of(ramp, Role::Visibility, Image(width, height, 1, Real(1))), "");
  Image holes = ramp;
  holes.at(3, 3, 0) = nan;
  EXPECT_EQ(reason_of(holes, Role::Visibility), "");
  // One depth everywhere in front of the sky: the feature is the outline.
  EXPECT_EQ(reason_of(image_of(width, height, 1, [](int x, int, int) { return x < 9 ? 4 : 1e10; }), Role::Depth), "");
}

/// The sun in a mirror: one pixel of the albedo has a value of thousands, and so has its noise.
TEST(LookAt, ASpikeIsNeitherTheScaleOfAFeatureNorItsNoise) {
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  Feature& albedo = frame.features.front();
  ASSERT_EQ(albedo.role, Role::Albedo);
  albedo.pass.variance = Image(width, height, 3, Real(1e-4));
  const Preparation before = choose_features(frame);
  for (int c = 0; c < 3; ++c) {
    albedo.pass.mean.at(5, 5, c) = Real(1000);
    albedo.pass.variance.at(5, 5, c) = Real(1e6);
  }
  const Preparation after = choose_features(frame);
  ASSERT_EQ(after.features.size(), before.features.size());
  EXPECT_EQ(after.features.front().scale, before.features.front().scale);
}

TEST(LookAt, PrefiltersOnlyNoisyFeatures) {
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  frame.features.resize(2);
  frame.features[1].pass.variance = Image(width, height, 3, Real(0.001));
  const Preparation out = choose_features(frame);
  ASSERT_EQ(out.features.size(), 2u);
  EXPECT_FALSE(out.features[0].prefilter);
  EXPECT_TRUE(out.features[1].prefilter);
}

TEST(LookAt, ABeautyWithoutAFinitePixelFailsTheCheck) {
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  frame.beauty.mean = Image(width, height, 3, nan);
  try {
    choose_features(frame);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::CheckFailed);
    EXPECT_NE(std::string(e.what()).find("Combined"), std::string::npos);
  }
}

TEST(LookAt, EpsilonIsTheSquareOfThreeTenthsOfTheMeanBrightness) {
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  frame.features.clear();
  frame.beauty.mean = Image(width, height, 3, Real(2));
  EXPECT_NEAR(choose_features(frame).epsilon, 0.36, 1e-9);
  frame.beauty.mean = Image(width, height, 3);
  EXPECT_EQ(choose_features(frame).epsilon, 1);  // all black: anything positive
}

TEST(LookAt, MoreFeaturesThanTheModelHoldsAreDropped) {
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  const Feature normal = frame.features[1];
  frame.features.assign(7, normal);
  int channels = 0;
  const Preparation out = choose_features(frame);
  for (const FeatureUse& use : out.features) channels += frame.features[use.index].pass.mean.channels();
  EXPECT_LE(channels, BasisLayout::max_features);
  EXPECT_EQ(out.features.size(), 5u);  // 5 x 3 = 15 of 16
  EXPECT_NE(std::find_if(out.decisions.begin(), out.decisions.end(),
                         [](const Decision& d) { return !d.run && d.step == "feature normal"; }),
            out.decisions.end());
}

TEST(Prepare, FeaturesAtAnyScaleAreTheSameNumbers) {
  // Powers of two near 1e-6 and 1e6: the scaling is exact, so the prepared values have the same bits.
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  const Prepared plain = prepared(frame);
  for (const double factor : {0x1p-20, 0x1p20}) {
    Frame scaled = frame;
    for (Feature& feature : scaled.features) feature.pass.mean = test::times(feature.pass.mean, factor);
    const Prepared out = prepared(scaled);
    // Depth enters as z / (z + median): rounding of the median's sum aside, without scale too.
    for (std::size_t h = 0; h < 2; ++h)
      EXPECT_LT(test::max_difference(out.pair.features[h], plain.pair.features[h]), 1e-6) << factor;
  }
  for (const double factor : {1e-6, 1e6}) {
    Frame scaled = frame;
    for (Feature& feature : scaled.features) feature.pass.mean = test::times(feature.pass.mean, factor);
    const double largest = test::max_magnitude(prepared(scaled).pair.features[0]);
    EXPECT_GE(largest, 0.5);
    EXPECT_LT(largest, 2);
  }
}

TEST(Prepare, ASkyAt1e10IsBoundedAndApartFromWhatIsNear) {
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  frame.features = {
      {Role::Depth,
       {"Depth", image_of(width, height, 1, [](int x, int, int) { return x < 16 ? 2 + 0.1 * x : 1e10; }), {}, {}, {}}}};
  const Image depth = prepared(frame).pair.features[0];
  // The median of the 16 near depths 2 .. 3.5 (the upper one) is 2.8: 2 / 4.8 at the left, 1 in the sky.
  EXPECT_NEAR(static_cast<double>(depth.at(0, 0, 0)), 2 / 4.8, 1e-6);
  EXPECT_NEAR(static_cast<double>(depth.at(20, 5, 0)), 1, 1e-6);
}

TEST(Prepare, TheVarianceOfAHalfIsTwiceThatOfTheMean) {
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  EXPECT_LT(test::max_difference(prepared(frame).pair.variance, test::times(frame.beauty.variance, 2)), 1e-9);
  frame.beauty.variance.at(3, 3, 1) = -1;
  EXPECT_EQ(prepared(frame).pair.variance.at(3, 3, 1), Real(0));
}

/// Filtered by itself, a feature would keep noise that its weights follow.
TEST(Prepare, AFeatureOfEstimatedNoiseIsFilteredByHalvesAndJoined) {
  const double sigma = 0.05;
  test::Random random(41);
  const auto wall = [](int x) { return x < width / 2 ? 1.2 : 1.6; };  // of order 1, so it is not scaled
  const auto noisy = [&](int x, int, int) { return wall(x) + sigma * random.normal(); };
  Frame frame = make_scene(width, height, 0.1, 1).frame;
  Pass pass{"f", image_of(width, height, 3, noisy), Image(width, height, 3, Real(sigma * sigma)), {}, {}};
  pass.variance_is_estimated = true;
  frame.features = {{Role::Albedo, pass}};
  const std::array<Image, 2> features = prepared(frame).pair.features;
  EXPECT_TRUE(test::same_bits(features[0], features[1]));
  double squares = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double error = static_cast<double>(features[0].at(x, y, 0)) - wall(x);
      squares += error * error / (width * height);
    }
  EXPECT_LT(squares, sigma * sigma / 30);
}

TEST(Prepare, LayersThatAddUpHaveHalvesThatAddUp) {
  for (const bool with_halves : {true, false}) {
    Frame frame = make_scene(width, height, 0.2, 5).frame;
    if (!with_halves) frame.beauty.half_a = frame.beauty.half_b = Image();
    const auto part = [&](double share) {
      return image_of(width, height, 3, [&](int x, int y, int c) {
        const double s = 0.5 + 0.3 * std::sin(0.2 * x + c);
        return static_cast<double>(frame.beauty.mean.at(x, y, c)) * (share > 0 ? s : 1 - s);
      });
    };
    frame.aovs = {{"Diffuse", part(1), {}, {}, {}}, {"Glossy", part(0), {}, {}, {}}};
    const Prepared out = prepared(frame);
    EXPECT_EQ(out.independent_halves, with_halves);
    for (const Image& half : out.pair.color)
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < half.pixels(); ++i) {
          const double sum = static_cast<double>(half.plane(3 + c)[i]) + static_cast<double>(half.plane(6 + c)[i]);
          ASSERT_NEAR(sum, static_cast<double>(half.plane(c)[i]), 1e-5);
        }
  }
}

TEST(Prepare, NonFinitePixelsAreRepairedAndCounted) {
  Frame frame = make_scene(width, height, 0.1, 6).frame;
  frame.beauty.half_a.at(4, 4, 1) = nan;
  frame.beauty.half_b.at(9, 9, 0) = std::numeric_limits<Real>::infinity();
  frame.features[0].pass.mean.at(2, 2, 0) = Real(-1e30);
  frame.beauty.mean.at(7, 7, 2) = Real(-0.5);
  const Prepared out = prepared(frame);
  EXPECT_EQ(out.repaired_pixels, 3u);
  EXPECT_EQ(out.negative_pixels, 1u);
  for (std::size_t h = 0; h < 2; ++h) {
    EXPECT_TRUE(test::all_finite(out.pair.color[h]));
    EXPECT_TRUE(test::all_finite(out.pair.features[h]));
  }
}

TEST(Prepare, AlphaIsTheLastChannelIfRequested) {
  Frame frame = make_scene(width, height, 0.1, 7).frame;
  frame.alpha = Image(width, height, 1, Real(0.25));
  EXPECT_EQ(prepared(frame).pair.color[0].channels(), 4);
  EXPECT_EQ(prepared(frame).pair.color[1].at(3, 3, 3), Real(0.25));
  EXPECT_EQ(prepared(frame, false).pair.color[0].channels(), 3);
}

}  // namespace
}  // namespace polyrecon
