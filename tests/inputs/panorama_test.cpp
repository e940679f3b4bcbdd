// Panoramas, whose last column is next to the first.
#include <OpenEXR/ImfEnvmapAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/wrap.h"
#include "io/exr_fixture.h"
#include "pipeline/memory.h"
#include "polyrecon/read_frame.h"
#include "support/reconstruction.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

using namespace testing;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double turn = 6.283185307179586;

/// The image turned by some columns.
Image turned(const Image& image, int by) {
  return test::image_of(image.width(), image.height(), image.channels(), [&](int x, int y, int c) {
    return static_cast<double>(image.at((x + by) % image.width(), y, c));
  });
}

/// A panorama of known truth, whose stripes and light go on over the seam.
test::Scene panorama(int width, int height) {
  test::Scene scene = test::make_scene(width, height, 0.3, 11);
  const auto albedo = [&](int x, int y, int) { return 0.5 + 0.3 * (((x + 8) / 16 + y / 16) % 2); };
  const Image& before = scene.truth;
  const Image truth = test::image_of(width, height, 3, [&](int x, int y, int c) {
    return albedo(x, y, c) * (1 + 0.5 * std::sin(turn * x / width + c) + 0.3 * std::sin(0.1 * y));
  });
  Pass& beauty = scene.frame.beauty;
  for (Image* image : {&beauty.mean, &beauty.half_a, &beauty.half_b})  // the same relative noise
    *image = test::image_of(width, height, 3, [&](int x, int y, int c) {
      const double t = before.at(x, y, c);
      return truth.at(x, y, c) * (1 + (image->at(x, y, c) - t) / (t + 0.1));
    });
  beauty.variance = test::image_of(
      width, height, 3, [&](int x, int y, int c) { return std::pow(0.3 * static_cast<double>(truth.at(x, y, c)), 2); });
  scene.truth = truth;
  scene.frame.features.resize(1);
  scene.frame.features[0].pass.mean = test::image_of(width, height, 3, albedo);
  scene.frame.alpha = Image(width, height, 1, 1);
  scene.frame.sample_count = Image(width, height, 1, 16);
  scene.frame.wraps = true;
  return scene;
}

TEST(Panorama, ColumnsOfTheOtherEndAreNextToEachEnd) {
  for (const int width : {1, 50, 128, 300}) {
    const Image image = test::image_of(width, 3, 2, [](int x, int y, int c) { return x + 1000 * y + 5000 * c; });
    const Image wide = wrapped(image);
    ASSERT_EQ(wide.width(), width + 2 * wrap_margin);
    for (int x = 0; x < wide.width(); ++x)
      ASSERT_EQ(wide.at(x, 2, 1), image.at((x - wrap_margin + 1000 * width) % width, 2, 1)) << width << " " << x;
    EXPECT_TRUE(test::same_bits(unwrapped(wide), image));
  }
}

/// The seam is a place like any other: turned by half, the result is the same, turned by half.
TEST(Panorama, TheResultTurnsWithTheFrame) {
  const int width = 256, height = 64;
  const test::Scene scene = panorama(width, height);
  Frame other = scene.frame;
  for (Image* image : {&other.beauty.mean, &other.beauty.variance, &other.beauty.half_a, &other.beauty.half_b,
                       &other.features[0].pass.mean})
    *image = turned(*image, width / 2);
  Params params = test::quick();
  params.components.restore_totals = false;  // totals include the repeated columns
  const Result a = test::run(scene.frame, params), b = test::run(other, params);
  EXPECT_LT(test::max_difference(turned(a.beauty, width / 2), b.beauty), 1e-5);
  EXPECT_LT(test::max_difference(turned(a.error.relative_mse, width / 2), b.error.relative_mse), 1e-5);
  Frame flat = scene.frame;
  flat.wraps = false;
  other.wraps = false;
  const Image turned_flat = turned(test::run(flat, params).beauty, width / 2);
  EXPECT_GT(test::max_difference(turned_flat, test::run(other, params).beauty), 1e-2);
}

TEST(Panorama, KeepsTheEnergyOfTheFrame) {
  const test::Scene scene = panorama(256, 64);
  const Result result = test::run(scene.frame);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(test::sum_of(result.beauty, c) / test::sum_of(scene.frame.beauty.mean, c), 1, 1e-3);
}

TEST(Panorama, EveryImageAndFigureIsThatOfTheFrame) {
  Frame frame = panorama(100, 40).frame;
  const Frame before = frame;
  Params params = test::quick();
  params.reconstruct_alpha = true;
  const Result result = reconstruct(frame, params, silent_progress());
  for (const Image* image : {&result.beauty, &result.alpha, &result.order, &result.error.mse,
                             &result.error.relative_mse, &result.error.relative_variance, &result.error.relative_noise})
    EXPECT_EQ(image->bounds(), (Rect{0, 0, 100, 40}));
  EXPECT_TRUE(test::same_bits(frame.sample_count, before.sample_count));
  EXPECT_EQ(result.report.width, 100);
  EXPECT_NEAR(result.report.energy_before[0], test::sum_of(before.beauty.mean, 0) / 4000, 1e-6);
  EXPECT_NEAR(result.report.energy_after[0], test::sum_of(result.beauty, 0) / 4000, 1e-6);
  EXPECT_NEAR(result.report.estimated_relative_mse, test::sum_of(result.error.relative_mse, 0) / 4000, 1e-6);
}

TEST(Panorama, RepeatedColumnsCountInTheMemoryStatement) {
  Frame frame = panorama(100, 40).frame;
  const std::size_t with = memory_needs(shape_of(frame), Params()).prepare;
  wrap(frame);
  EXPECT_EQ(with, memory_needs(shape_of(frame), Params()).prepare);
}

TestPart part_with_envmap(Imf::Envmap map, const Rect& window) {
  TestPart part = part_over(window, {0, 0, 8, 6}, layer("", "RGB"));
  part.edit = [map](Imf::Header& header) { header.insert("envmap", Imf::EnvmapAttribute(map)); };
  return part;
}

TEST(Panorama, IsFoundByOpenExrsAttributeOrByHand) {
  const TemporaryFolder folder;
  const std::string map = write_exr(folder / "map.exr", {part_with_envmap(Imf::ENVMAP_LATLONG, {0, 0, 8, 6})});
  const std::string cube = write_exr(folder / "cube.exr", {part_with_envmap(Imf::ENVMAP_CUBE, {0, 0, 8, 6})});
  const std::string cut = write_exr(folder / "cut.exr", {part_with_envmap(Imf::ENVMAP_LATLONG, {0, 0, 7, 6})});
  const ReadResult by_itself = read_frame(map);
  EXPECT_TRUE(by_itself.frame.wraps);
  EXPECT_THAT(by_itself.notes, Contains(HasSubstr("--wrap none")));
  EXPECT_FALSE(read_frame(cube).frame.wraps);
  const ReadResult region = read_frame(cut);
  EXPECT_FALSE(region.frame.wraps);
  EXPECT_THAT(region.notes, Contains(HasSubstr("do not wrap")));
  ReadOptions options;
  options.wrap = Wrap::None;
  EXPECT_FALSE(read_frame(map, options).frame.wraps);
  EXPECT_THAT(read_frame(map, options).notes, IsEmpty());
  options.wrap = Wrap::X;
  EXPECT_TRUE(read_frame(cube, options).frame.wraps);
}

}  // namespace
}  // namespace polyrecon
