#include "outliers/restore.h"

#include <gtest/gtest.h>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

constexpr double max_gain = 0.02;

Image smooth_image(int channels) {
  return test::image_of(64, 48, channels,
                        [](int x, int y, int c) { return 0.5 + 0.01 * x + 0.02 * y + 0.1 * (c % 3); });
}

/// sum of each channel after = before + what the outliers hold, to 1e-6 of the sum.
void expect_energy(const Image& before, const Image& after, const std::vector<Outlier>& outliers) {
  for (int c = 0; c < before.channels(); ++c) {
    double energy = 0;
    for (const Outlier& o : outliers) energy += o.energy[static_cast<std::size_t>(c)];
    const double expected = test::sum_of(before, c) + energy;
    EXPECT_NEAR(test::sum_of(after, c), expected, 1e-6 * std::abs(expected)) << c;
  }
}

TEST(RestoreEnergy, GivesBackExactlyWhatWasTaken) {
  const Image before = smooth_image(3);
  test::Random random(1);
  std::vector<Outlier> outliers{{0, 0, {1, 2, 3}}, {63, 47, {3, 0.1, 0}}, {63, 20, {10, 10, 10}}};
  for (int k = 0; k < 40; ++k)
    outliers.push_back({random.below(64), random.below(48), {random.uniform(), random.uniform(), random.uniform()}});
  Image after = before;
  restore_energy(outliers, max_gain, after);
  expect_energy(before, after, outliers);
  EXPECT_TRUE(test::all_finite(after));
}

TEST(RestoreEnergy, NothingTakenNothingGiven) {
  Image image = smooth_image(3);
  restore_energy({}, max_gain, image);
  EXPECT_TRUE(test::same_bits(image, smooth_image(3)));
}

/// One outlier alone: equation (10) with one rho for all of Omega_o, at most the gain allowed while that fits into the
/// image.
TEST(RestoreEnergy, OneOutlierBrightensItsSurroundingsByOneFactor) {
  const Image before = smooth_image(3);
  Image after = before;
  restore_energy({{30, 20, {5, 5, 5}}}, max_gain, after);
  for (int c = 0; c < 3; ++c) {
    double gain = 0, sum = 0;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const double g = static_cast<double>(after.at(x, y, c)) / static_cast<double>(before.at(x, y, c)) - 1;
        if (g < 1e-7) continue;
        if (gain == 0) gain = g;
        EXPECT_NEAR(g, gain, 5e-7);
        sum += static_cast<double>(before.at(x, y, c));
      }
    EXPECT_GT(gain, 0);
    EXPECT_LE(gain, max_gain + 1e-6);
    EXPECT_NEAR(gain * sum, 5, 1e-3);  // equation (11)
  }
}

TEST(RestoreEnergy, MoreThanTheGainAllowsGoesToTheWholeImage) {
  const Image before = smooth_image(3);
  Image after = before;
  const std::vector<Outlier> outliers{{30, 20, {1000, 1000, 1000}}};  // the whole image holds about 4000
  restore_energy(outliers, max_gain, after);
  expect_energy(before, after, outliers);
  const double rho = 1000 / test::sum_of(before, 0);
  EXPECT_NEAR(static_cast<double>(after.at(0, 0, 0)), static_cast<double>(before.at(0, 0, 0)) * (1 + rho), 1e-5);
  EXPECT_NEAR(static_cast<double>(after.at(63, 47, 0)), static_cast<double>(before.at(63, 47, 0)) * (1 + rho), 1e-5);
}

TEST(RestoreEnergy, OnBlackItGoesBackToItsPlace) {
  Image image(20, 20, 3);
  restore_energy({{7, 8, {1, 2, 3}}}, max_gain, image);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(static_cast<double>(image.at(7, 8, c)), c + 1);
    EXPECT_EQ(test::sum_of(image, c), c + 1);
  }
}

TEST(RestoreEnergy, OneBlackChannelGetsItsEnergyBackToo) {
  Image image = smooth_image(3);
  std::fill(image.plane(2), image.plane(2) + image.pixels(), Real(0));
  const Image before = image;
  const std::vector<Outlier> outliers{{7, 8, {1, 2, 3}}, {40, 30, {0.5, 0.5, 0.5}}};
  restore_energy(outliers, max_gain, image);
  expect_energy(before, image, outliers);
}

TEST(RestoreEnergy, NegativePixelsDoNotGrow) {
  Image image = smooth_image(3);
  image.at(30, 21, 0) = Real(-0.5);
  const Image before = image;
  const std::vector<Outlier> outliers{{30, 20, {5, 5, 5}}};
  restore_energy(outliers, max_gain, image);
  EXPECT_EQ(image.at(30, 21, 0), Real(-0.5));
  expect_energy(before, image, outliers);
}

TEST(RestoreEnergy, LayersThatAddUpStillDo) {
  // Channels 3-5 and 6-8 add up to 0-2, pixel by pixel and outlier by outlier.
  Image image = test::image_of(64, 48, 9, [](int x, int y, int c) {
    const double v = 0.5 + 0.01 * x + 0.02 * y + 0.1 * (c % 3), share = 0.2 + 0.6 * ((x / 8) % 2);
    return c < 3 ? v : c < 6 ? share * v : (1 - share) * v;
  });
  const Image before = image;
  const std::vector<Outlier> outliers{{30, 20, {5, 6, 7, 4, 6, 0, 1, 0, 7}},
                                      {0, 40, {1, 1, 1, 0.5, 0.25, 1, 0.5, 0.75, 0}}};
  restore_energy(outliers, max_gain, image);
  expect_energy(before, image, outliers);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      ASSERT_NEAR(static_cast<double>(image.plane(3 + c)[i]) + static_cast<double>(image.plane(6 + c)[i]),
                  static_cast<double>(image.plane(c)[i]), 1e-6 * static_cast<double>(image.plane(c)[i]));
}

TEST(RestoreEnergy, AlphaIsLeftAlone) {
  Image image = smooth_image(4);
  const Image before = image;
  restore_energy({{30, 20, {5, 5, 5, 0}}}, max_gain, image);
  for (std::size_t i = 0; i < image.pixels(); ++i) ASSERT_EQ(image.plane(3)[i], before.plane(3)[i]);
}

}  // namespace
}  // namespace polyrecon
