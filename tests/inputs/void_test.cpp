// Pixels in which nothing was rendered: surroundings of a render region, transparent film, gaps of a light map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <utility>

#include "core/crop_frame.h"
#include "core/mask.h"
#include "core/void_pixels.h"
#include "pipeline/memory.h"
#include "support/reconstruction.h"
#include "support/scene.h"
#include "temporal/neighbour.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();

/// A scene of known truth with alpha 1, of which only `region` was rendered.
test::Scene cut_to(const Rect& region, int width, int height) {
  test::Scene scene = test::make_scene(width, height, 0.3, 5);
  Frame& frame = scene.frame;
  frame.alpha = Image(width, height, 1, 1);
  const auto keep = [&](Image& image) {
    for (int c = 0; c < image.channels(); ++c)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          if (!region.contains(x, y)) image.at(x, y, c) = 0;
  };
  for (Image* image : {&frame.alpha, &frame.beauty.mean, &frame.beauty.variance, &frame.beauty.half_a,
                       &frame.beauty.half_b, &scene.truth})
    keep(*image);
  for (Feature& feature : frame.features) keep(feature.pass.mean);
  return scene;
}

/// The rendered pixels as a rectangle; the whole frame where the mask is empty.
Rect rendered_box(const Frame& frame) {
  const Image rendered = rendered_mask(frame);
  Rect box{frame.width(), frame.height(), 0, 0};
  for (int y = 0; y < frame.height(); ++y)
    for (int x = 0; x < frame.width(); ++x)
      if (in_mask(rendered, frame.beauty.mean.index(x, y)))
        box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
  return box;
}

const Rect region{10, 8, 58, 40};

TEST(Void, IsWhereBeautyAlphaAndFeaturesAreZero) {
  const test::Scene scene = cut_to(region, 72, 50);
  EXPECT_EQ(rendered_box(scene.frame), region);
  Frame frame = scene.frame;
  frame.alpha = {};  // the features tell
  EXPECT_EQ(rendered_box(frame), region);
  frame = scene.frame;
  frame.features.clear();  // the alpha tells
  EXPECT_EQ(rendered_box(frame), region);
  frame.alpha = {};  // nothing tells black from nothing
  EXPECT_EQ(rendered_box(frame), frame.beauty.mean.bounds());
}

TEST(Void, IsNotWhereAnyPassShowsSomething) {
  const test::Scene scene = cut_to(region, 72, 50);
  Frame frame = scene.frame;
  frame.features[0].pass.mean.at(2, 3, 1) = Real(0.1);
  EXPECT_EQ(rendered_box(frame), (Rect{2, 3, 58, 40}));
  frame = scene.frame;
  frame.alpha.at(68, 46, 0) = Real(0.01);
  EXPECT_EQ(rendered_box(frame), (Rect{10, 8, 69, 47}));
  frame = scene.frame;
  frame.aovs.push_back({"Glow", Image(72, 50, 3), {}, {}, {}});
  frame.aovs[0].mean.at(5, 45, 2) = 1;
  EXPECT_EQ(rendered_box(frame), (Rect{5, 8, 58, 46}));
}

TEST(Void, MayHoldTheSkysDepthFullVisibilityAndValuesThatAreNotFinite) {
  test::Scene scene = cut_to(region, 72, 50);
  Frame& frame = scene.frame;
  frame.features.push_back({Role::Visibility, {"AO", Image(72, 50, 1, 1), {}, {}, {}}});
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 72; ++x) {
      if (region.contains(x, y)) continue;
      frame.features[2].pass.mean.at(x, y, 0) = Real(1e10);
      frame.beauty.mean.at(x, y, 0) = nan;
    }
  EXPECT_EQ(rendered_box(frame), region);
  EXPECT_TRUE(test::all_finite(test::run(frame).beauty));
}

/// What a feature holds where nothing was rendered is the table's to say.
TEST(Void, IsWhereEachFeatureHoldsItsEmptyValue) {
  for (const RoleInfo& info : role_table()) {
    if (!info.feature) continue;
    for (const auto& [value, empty] : std::map<double, bool>{{0, true},
                                                             {0.5, false},
                                                             {1, info.empty == EmptyValue::ZeroOrOne},
                                                             {1e10, info.empty == EmptyValue::ZeroOrSky}}) {
      Frame frame = cut_to(region, 72, 50).frame;
      Image mean =
          test::image_of(72, 50, info.channels, [&](int x, int y, int) { return region.contains(x, y) ? 0.3 : value; });
      frame.features = {{info.role, {info.name, std::move(mean), {}, {}, {}}}};
      EXPECT_EQ(rendered_mask(frame).empty(), !empty) << info.name << " " << value;
    }
  }
  EXPECT_EQ(info_of(Role::Depth).empty, EmptyValue::ZeroOrSky);
  EXPECT_EQ(info_of(Role::Visibility).empty, EmptyValue::ZeroOrOne);
}

/// A frame in which nothing is visible, or everything, is an ordinary one.
TEST(Void, IsNotTheWholeFrame) {
  test::Scene scene = cut_to({}, 40, 30);
  EXPECT_TRUE(rendered_mask(scene.frame).empty());
  const Result result = test::run(scene.frame);
  EXPECT_EQ(test::max_magnitude(result.beauty), 0);
}

/// A thin volume without features: most pixels of it saw nothing by chance, which is no void.
TEST(Void, IsNotWhatSamplesMissedByChance) {
  test::Random random(3);
  Frame frame;
  frame.beauty.name = "Combined";
  frame.beauty.mean = Image(80, 60, 3);
  frame.alpha = Image(80, 60, 1);
  const Rect volume{20, 15, 60, 45};
  for (int y = volume.y0; y < volume.y1; ++y)
    for (int x = volume.x0; x < volume.x1; ++x)
      if (random.uniform() < 0.15) {
        for (int c = 0; c < 3; ++c) frame.beauty.mean.at(x, y, c) = 1;
        frame.alpha.at(x, y, 0) = Real(0.1);
      }
  const Image rendered = rendered_mask(frame);
  ASSERT_FALSE(rendered.empty());
  EXPECT_FALSE(in_mask(rendered, rendered.index(1, 1)));
  std::size_t inside = 0;
  for (int y = volume.y0; y < volume.y1; ++y)
    for (int x = volume.x0; x < volume.x1; ++x) inside += in_mask(rendered, rendered.index(x, y));
  EXPECT_EQ(inside, volume.area());
}

TEST(Void, IsNoLonePixel) {
  test::Scene scene = cut_to(region, 72, 50);
  scene.frame.features.clear();
  scene.frame.alpha.at(30, 20, 0) = 0;
  for (int c = 0; c < 3; ++c) scene.frame.beauty.mean.at(30, 20, c) = 0;
  const Image rendered = rendered_mask(scene.frame);
  EXPECT_TRUE(in_mask(rendered, rendered.index(30, 20)));
  EXPECT_FALSE(in_mask(rendered, rendered.index(9, 20)));
}

/// At a hard border the scene was cut off, at a soft one it ends.
TEST(Void, IsASampleOfThePictureAtSoftBordersOnly) {
  test::Scene scene = cut_to(region, 72, 50);
  const Image rendered = rendered_mask(scene.frame);
  EXPECT_TRUE(test::same_bits(sampled_mask(rendered, scene.frame), rendered));
  for (int y = region.y0; y < region.y1; ++y) scene.frame.alpha.at(region.x0, y, 0) = Real(0.5);
  const Image sampled = sampled_mask(rendered, scene.frame);
  EXPECT_TRUE(in_mask(sampled, sampled.index(0, 20)));    // left of a silhouette
  EXPECT_FALSE(in_mask(sampled, sampled.index(60, 20)));  // right of a cut
}

TEST(Void, StaysZeroAndTheRimOfARegionIsAsGoodAsThatOfACrop) {
  const Rect cut{64, 64, 192, 128};  // at multiples of the blocks, so that both have the same centres
  const test::Scene scene = cut_to(cut, 224, 160);
  const Result black = test::run(scene.frame);
  const Result cropped = test::run(crop(scene.frame, cut));
  EXPECT_THAT(black.report.decisions, Contains(::testing::Field(&Decision::step, "void pixels skipped")));
  double outside = 0, error_outside = 0;
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 224; ++x) {
      if (cut.contains(x, y)) continue;
      error_outside += static_cast<double>(black.error.relative_mse.at(x, y, 0));
      for (int c = 0; c < 3; ++c) outside += std::abs(static_cast<double>(black.beauty.at(x, y, c)));
    }
  EXPECT_EQ(outside, 0);
  EXPECT_EQ(error_outside, 0);
  const Image truth = crop(scene.truth, cut);
  const auto rim_error = [&](const Image& image) {
    double sum = 0;
    for (const Rect& side : {Rect{0, 0, 128, 4}, Rect{0, 60, 128, 64}, Rect{0, 4, 4, 60}, Rect{124, 4, 128, 60}})
      sum += static_cast<double>(side.area()) * test::relative_mse(crop(image, side), crop(truth, side));
    return sum;
  };
  EXPECT_LT(rim_error(crop(black.beauty, cut)), 1.1 * rim_error(cropped.beauty));
  const Rect inner{8, 8, 120, 56};
  EXPECT_NEAR(test::relative_mse(crop(crop(black.beauty, cut), inner), crop(truth, inner)),
              test::relative_mse(crop(cropped.beauty, inner), crop(truth, inner)), 1e-5);
}

TEST(Void, ResultsDoNotDependOnTiles) {
  const test::Scene scene = cut_to({30, 20, 500, 180}, 520, 200);
  Params params = test::quick();
  const Result whole = test::run(scene.frame, params);
  params.max_memory = memory_needs(shape_of(scene.frame), params).least();
  const Result tiled = test::run(scene.frame, params);
  EXPECT_TRUE(test::same_bits(whole.beauty, tiled.beauty));
  EXPECT_TRUE(test::same_bits(whole.error.mse, tiled.error.mse));
}

/// What a renderer leaves in void pixels (0, NaN, the depth of the sky) is hidden before anything is measured, in
/// neighbours in time too.
TEST(Void, OfNeighboursMayHoldAnythingThatMeansNothing) {
  Frame zeros = cut_to(region, 72, 50).frame;
  zeros.beauty.variance = zeros.beauty.half_a = zeros.beauty.half_b = {};  // the noise is estimated
  Frame others = zeros;
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 72; ++x) {
      if (region.contains(x, y)) continue;
      for (int c = 0; c < 3; ++c) others.beauty.mean.at(x, y, c) = nan;
      others.features[2].pass.mean.at(x, y, 0) = Real(1e10);
    }
  const auto a = prepare_neighbour(zeros, 1, test::quick(), silent_progress());
  const auto b = prepare_neighbour(others, 1, test::quick(), silent_progress());
  EXPECT_FALSE(a->pair.sampled.empty());
  EXPECT_TRUE(test::same_bits(a->pair.sampled, b->pair.sampled));
  EXPECT_TRUE(test::same_bits(a->pair.variance, b->pair.variance));
  for (std::size_t h = 0; h < 2; ++h) EXPECT_TRUE(test::same_bits(a->pair.color[h], b->pair.color[h]));
  for (std::size_t s = 0; s < surfaces; ++s)
    EXPECT_TRUE(test::same_bits(a->geometry.surface[s], b->geometry.surface[s])) << s;
}

TEST(Void, RepairedPixelsAreThoseOfThePicture) {
  test::Scene scene = cut_to(region, 72, 50);
  scene.frame.beauty.half_a.at(30, 20, 0) = nan;
  EXPECT_EQ(test::run(scene.frame).report.repaired_pixels, 1U);
}

/// Alpha is reconstructed with the beauty and stays a coverage.
TEST(Alpha, StaysBetweenZeroAndOne) {
  test::Scene scene = test::make_scene(72, 50, 0.3, 5);
  test::Random random(7);
  scene.frame.alpha = test::image_of(72, 50, 1, [&](int x, int y, int) {
    const double d = std::hypot(x - 36, y - 25) - 15;
    return std::clamp(0.5 - d / 3, 0.0, 1.0) > random.uniform() ? 1 : 0;
  });
  Params params = test::quick();
  params.reconstruct_alpha = true;
  const Image alpha = test::run(scene.frame, params).alpha;
  for (std::size_t i = 0; i < alpha.pixels(); ++i) {
    EXPECT_GE(alpha.plane(0)[i], 0);
    EXPECT_LE(alpha.plane(0)[i], 1);
  }
}

}  // namespace
}  // namespace polyrecon
