#include "core/crop_frame.h"

#include <gtest/gtest.h>

#include "support/images.h"

namespace polyrecon {
namespace {

/// Every image of it has its own values.
Pass numbered_pass(const char* name, int channels, double base) {
  const auto image = [&](double offset) {
    return test::image_of(8, 6, channels, [=](int x, int y, int c) { return base + offset + x + 10 * y + 100 * c; });
  };
  return {name, image(0), image(0.1), image(0.2), image(0.3), true};
}

void expect_crop(const Image& part, const Image& whole, const Rect& r) {
  ASSERT_EQ(part.width(), r.width());
  ASSERT_EQ(part.height(), r.height());
  ASSERT_EQ(part.channels(), whole.channels());
  for (int c = 0; c < part.channels(); ++c)
    for (int y = 0; y < part.height(); ++y)
      for (int x = 0; x < part.width(); ++x) ASSERT_EQ(part.at(x, y, c), whole.at(x + r.x0, y + r.y0, c));
}

void expect_crop(const Pass& part, const Pass& whole, const Rect& r) {
  EXPECT_EQ(part.name, whole.name);
  EXPECT_EQ(part.variance_is_estimated, whole.variance_is_estimated);
  expect_crop(part.mean, whole.mean, r);
  expect_crop(part.variance, whole.variance, r);
  expect_crop(part.half_a, whole.half_a, r);
  expect_crop(part.half_b, whole.half_b, r);
}

TEST(CropFrame, KeepsEverythingInside) {
  Frame frame;
  frame.data_window = {-3, 5, 5, 11};
  frame.beauty = numbered_pass("beauty", 3, 1);
  frame.features.push_back({Role::Depth, numbered_pass("depth", 1, 2)});
  frame.features.push_back({Role::Albedo, numbered_pass("albedo", 3, 3)});
  frame.aovs.push_back(numbered_pass("aov", 3, 4));
  frame.prior = numbered_pass("prior", 3, 5);
  frame.alpha = numbered_pass("", 1, 6).mean;
  frame.sample_count = numbered_pass("", 1, 7).mean;
  frame.motion = numbered_pass("", 4, 8).mean;
  frame.sky_depth = 100;
  const Rect r{2, 1, 7, 5};
  const Frame part = crop(frame, r);
  EXPECT_EQ(part.data_window, (Rect{-1, 6, 4, 10}));
  expect_crop(part.beauty, frame.beauty, r);
  EXPECT_EQ(part.sky_depth, 100);
  ASSERT_EQ(part.features.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(part.features[k].role, frame.features[k].role);
    expect_crop(part.features[k].pass, frame.features[k].pass, r);
  }
  ASSERT_EQ(part.aovs.size(), 1u);
  expect_crop(part.aovs[0], frame.aovs[0], r);
  expect_crop(part.prior, frame.prior, r);
  expect_crop(part.alpha, frame.alpha, r);
  expect_crop(part.sample_count, frame.sample_count, r);
  expect_crop(part.motion, frame.motion, r);
}

TEST(CropFrame, WhatIsNotThereStaysEmpty) {
  Frame frame;
  frame.beauty.mean = Image(8, 6, 3);
  const Frame part = crop(frame, {0, 0, 4, 4});
  EXPECT_EQ(part.beauty.mean.width(), 4);
  EXPECT_FALSE(part.beauty.noise_is_known());
  for (const Image* image : {&part.prior.mean, &part.alpha, &part.sample_count, &part.motion})
    EXPECT_TRUE(image->empty());
}

}  // namespace
}  // namespace polyrecon
