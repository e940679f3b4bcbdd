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

/// Noise so strong that it hides every gain: all pixels take part fully.
Image loud(const Image& image) { return Image(image.width(), image.height(), 3, Real(1e30)); }

/// Checks that the sum of each channel has grown by the energy of the outliers, to 1e-6 of the sum.
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
  restore_energy(outliers, loud(after), max_gain, after);
  expect_energy(before, after, outliers);
  EXPECT_TRUE(test::all_finite(after));
}

/// The rim of a lamp, which is by far the brightest pixel of all areas, would take the energy of all outliers.
TEST(RestoreEnergy, ARimAmongManyOutliersGainsLittle) {
  Image before = smooth_image(6);  // with a layer that is the beauty
  for (int c = 0; c < 6; ++c) before.at(30, 20, c) = Real(20);
  test::Random random(2);
  std::vector<Outlier> outliers;
  for (int k = 0; k < 60; ++k) {
    const double e = 0.5 * random.uniform();
    outliers.push_back({20 + random.below(20), 10 + random.below(20), {e, e, e, e, e, e}});
  }
  Image after = before;
  restore_energy(outliers, loud(after), 0.2, after);
  expect_energy(before, after, outliers);
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(after.at(30, 20, c), Real(20.6));
    EXPECT_LT(after.at(30, 20, c), Real(21.5));  // with its part of what goes to the whole image
  }
  for (int c = 0; c < 3; ++c) EXPECT_EQ(test::sum_of(after, c), test::sum_of(after, c + 3)) << c;
}

TEST(RestoreEnergy, NothingTakenNothingGiven) {
  Image image = smooth_image(3);
  restore_energy({}, loud(image), max_gain, image);
  EXPECT_TRUE(test::same_bits(image, smooth_image(3)));
}

/// The pixels of Omega_o: those that gained energy.
TEST(RestoreEnergy, EveryPixelsGainIsProportionalToItsBrightness) {
  const Image before = smooth_image(3);
  Image after = before;
  restore_energy({{30, 20, {5, 5, 5}}}, loud(after), max_gain, after);
  for (int c = 0; c < 3; ++c) {
    double squares = 0, squared_gains = 0;
    int pixels = 0;
    for (std::size_t i = 0; i < before.pixels(); ++i) {
      const auto yhat = static_cast<double>(before.plane(c)[i]), gained = static_cast<double>(after.plane(c)[i]) - yhat;
      if (gained < 1e-7) continue;
      squares += yhat * yhat;
      squared_gains += std::pow(gained / yhat, 2);
      ++pixels;
    }
    EXPECT_LT(pixels, static_cast<int>(before.pixels()));
    EXPECT_LE(std::sqrt(squared_gains / pixels), max_gain * (1 + 1e-3));
    for (std::size_t i = 0; i < before.pixels(); ++i) {
      const auto yhat = static_cast<double>(before.plane(c)[i]), gained = static_cast<double>(after.plane(c)[i]) - yhat;
      if (gained >= 1e-7) {
        ASSERT_NEAR(gained / yhat, 5 * yhat / squares, 5e-7);
      }
    }
  }
}

TEST(RestoreEnergy, MoreThanTheGainAllowsGoesToTheWholeImage) {
  const Image before = smooth_image(3);
  Image after = before;
  const std::vector<Outlier> outliers{{30, 20, {1000, 1000, 1000}}};  // the whole image holds about 4000
  restore_energy(outliers, loud(after), max_gain, after);
  expect_energy(before, after, outliers);
  EXPECT_GT(static_cast<double>(after.at(0, 0, 0)) / static_cast<double>(before.at(0, 0, 0)), 1.02);
  EXPECT_GT(static_cast<double>(after.at(63, 47, 0)) / static_cast<double>(before.at(63, 47, 0)), 1.02);
}

/// No other way to add the same energy has a smaller sum of (d / yhat)^2: moving some of it between pixels increases
/// it.
TEST(RestoreEnergy, CostsTheLeastRelativeError) {
  const Image before = smooth_image(3);
  Image after = before;
  restore_energy({{30, 20, {500, 500, 500}}}, loud(after), max_gain, after);
  std::vector<double> d, yhat;
  for (std::size_t i = 0; i < before.pixels(); ++i) {
    yhat.push_back(static_cast<double>(before.plane(0)[i]));
    d.push_back(static_cast<double>(after.plane(0)[i]) - yhat.back());
  }
  const auto cost = [&](std::size_t i, double moved) { return std::pow((d[i] + moved) / yhat[i], 2); };
  test::Random random(3);
  for (int k = 0; k < 100; ++k) {
    const auto i = static_cast<std::size_t>(random.below(static_cast<int>(d.size())));
    const auto j = static_cast<std::size_t>(random.below(static_cast<int>(d.size())));
    if (i == j) continue;
    EXPECT_GT(cost(i, 0.01) + cost(j, -0.01), cost(i, 0) + cost(j, 0));
  }
}

/// A glint that the fit has dimmed receives most of the returned energy and hardly changes; the rest does not brighten.
TEST(RestoreEnergy, WhatIsBrightTakesMost) {
  Image image = smooth_image(3);
  for (int c = 0; c < 3; ++c) image.at(10, 10, c) = Real(300);
  const Image before = image;
  restore_energy({{30, 20, {50, 50, 50}}}, loud(image), max_gain, image);
  expect_energy(before, image, {{30, 20, {50, 50, 50}}});
  EXPECT_GT(static_cast<double>(image.at(10, 10, 0)), 345);
  EXPECT_LT(static_cast<double>(image.at(50, 40, 0)) / static_cast<double>(before.at(50, 40, 0)), 1.002);
}

TEST(RestoreEnergy, OnBlackItGoesBackToItsPlace) {
  Image image(20, 20, 3);
  restore_energy({{7, 8, {1, 2, 3}}}, loud(image), max_gain, image);
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
  restore_energy(outliers, loud(image), max_gain, image);
  expect_energy(before, image, outliers);
}

TEST(RestoreEnergy, NegativePixelsDoNotGrow) {
  Image image = smooth_image(3);
  image.at(30, 21, 0) = Real(-0.5);
  const Image before = image;
  const std::vector<Outlier> outliers{{30, 20, {5, 5, 5}}};
  restore_energy(outliers, loud(image), max_gain, image);
  EXPECT_EQ(image.at(30, 21, 0), Real(-0.5));
  expect_energy(before, image, outliers);
}

/// The square of a sun is 16 digits above those of the dark pixels around it. Energy taken from these returns to them.
TEST(RestoreEnergy, ASunDoesNotDrownTheDark) {
  Image image(200, 150, 3, Real(1e-3));
  for (int c = 0; c < 3; ++c) image.at(20, 20, c) = Real(1e6);
  const Image before = image;
  restore_energy({{150, 100, {1e-3, 1e-3, 1e-3}}}, loud(image), max_gain, image);
  for (int c = 0; c < 3; ++c) {
    double given = 0;
    for (int y = 91; y < 110; ++y)
      for (int x = 141; x < 160; ++x)
        given += static_cast<double>(image.at(x, y, c)) - static_cast<double>(before.at(x, y, c));
    EXPECT_NEAR(given, 1e-3, 1e-5) << c;
    EXPECT_EQ(image.at(20, 20, c), before.at(20, 20, c));
  }
}

/// Energy that is too much for any square around the outlier goes to all pixels, without making a lamp many times as
/// bright.
TEST(RestoreEnergy, ALampDoesNotTakeAllOfADarkRoom) {
  Image image(64, 48, 3, Real(0.1));
  for (int c = 0; c < 3; ++c) image.at(20, 20, c) = Real(5);
  const Image before = image;
  const std::vector<Outlier> outliers{{50, 30, {60, 60, 60}}};
  restore_energy(outliers, loud(image), max_gain, image);
  expect_energy(before, image, outliers);
  EXPECT_LT(static_cast<double>(image.at(20, 20, 0)), 5 * 1.6);
}

/// With more than half of all energy the bound on a gain cannot be met, so every pixel gains the same factor.
TEST(RestoreEnergy, WhatNoBoundHoldsGoesToAllAlike) {
  Image image(64, 48, 3, Real(0.1));
  for (int c = 0; c < 3; ++c) image.at(20, 20, c) = Real(5);
  const Image before = image;
  const double energy = 0.8 * channel_sums(image).front();
  restore_energy({{50, 30, {energy, energy, energy}}}, loud(image), max_gain, image);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(static_cast<double>(image.at(20, 20, c)), 5 * 1.8, 1e-4);
    EXPECT_NEAR(static_cast<double>(image.at(3, 40, c)), 0.1 * 1.8, 1e-6);
  }
}

/// The result is continuous where the bound on a gain sets in: a little more energy changes each pixel a little.
TEST(RestoreTotals, MeetsTheMostGainWithoutAStep) {
  double last = 0;
  for (double factor = 1; factor < 1.05; factor += 1e-4) {
    Image image(64, 48, 3, Real(0.1));
    for (int c = 0; c < 3; ++c) image.at(20, 20, c) = Real(5);
    std::vector<double> totals = channel_sums(image);
    for (double& total : totals) total *= factor;
    restore_totals(totals, loud(image), max_gain, 0.05, image);
    const double bright = static_cast<double>(image.at(20, 20, 0));
    EXPECT_LT(bright, 5 * 1.51);
    if (factor > 1) {
      EXPECT_LT(std::abs(bright - last), 0.04) << factor;
    }
    last = bright;
  }
}

/// One bright pixel in the dark would bear the whole change by squares, and would become negative.
TEST(RestoreTotals, NoPixelBecomesNegative) {
  for (const double factor : {0.96, 1.04}) {
    Image image(64, 48, 3, Real(0.1));
    for (int c = 0; c < 3; ++c) image.at(20, 20, c) = Real(5);
    std::vector<double> totals = channel_sums(image);
    for (double& total : totals) total *= factor;
    restore_totals(totals, loud(image), max_gain, 0.05, image);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(channel_sums(image)[static_cast<std::size_t>(c)], totals[static_cast<std::size_t>(c)], 1e-3);
      EXPECT_NEAR(static_cast<double>(image.at(20, 20, c)), factor > 1 ? 7.5 : 2.5,
                  1e-3);  // the largest change allowed
    }
  }
}

/// A sky of one colour without noise is exact, so all energy returns to the pixels that have noise.
TEST(RestoreEnergy, PixelsWithoutNoiseTakeNoPart) {
  Image image = smooth_image(3);
  const Image before = image;
  const Image variance = test::image_of(64, 48, 3, [](int x, int, int) { return x < 32 ? 0 : 1e-4; });
  const std::vector<Outlier> outliers{{30, 20, {5, 6, 7}}, {60, 20, {700, 700, 700}}};  // a square's, and all pixels'
  restore_energy(outliers, variance, max_gain, image);
  expect_energy(before, image, outliers);
  EXPECT_TRUE(test::same_bits(crop(image, {0, 0, 32, 48}), crop(before, {0, 0, 32, 48})));
}

/// Of two equally bright pixels, the one with half of the noise that would hide the gain receives half as much.
TEST(RestoreEnergy, LittleNoiseTakesPartByItsMeasure) {
  Image image(40, 40, 3, Real(1));
  const double hidden = 2 * max_gain * max_gain;  // variance of a half whose mean has max_gain as standard deviation
  const Image variance = test::image_of(40, 40, 3, [&](int x, int, int) { return x < 20 ? 4 * hidden : hidden / 4; });
  restore_energy({{20, 20, {2, 2, 2}}}, variance, max_gain, image);
  const double much = static_cast<double>(image.at(16, 20, 0)) - 1,
               little = static_cast<double>(image.at(24, 20, 0)) - 1;
  EXPECT_NEAR(little / much, 0.5, 1e-3);
}

TEST(RestoreEnergy, WithoutAnyNoiseItGoesBackToItsPlace) {
  Image image = smooth_image(3);
  const Image before = image;
  restore_energy({{7, 8, {1, 2, 3}}}, Image(64, 48, 3), max_gain, image);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(static_cast<double>(image.at(7, 8, c)), static_cast<double>(before.at(7, 8, c)) + c + 1, 1e-5);
}

TEST(RestoreTotals, PixelsWithoutNoiseKeepTheirValue) {
  Image image = smooth_image(3);
  const Image before = image;
  std::vector<double> totals = channel_sums(image);
  for (double& total : totals) total *= 1.01;
  restore_totals(totals, test::image_of(64, 48, 3, [](int x, int, int) { return x < 32 ? 0 : 1; }), max_gain, 0.05,
                 image);
  EXPECT_TRUE(test::same_bits(crop(image, {0, 0, 32, 48}), crop(before, {0, 0, 32, 48})));
  for (int c = 0; c < 3; ++c) {
    const double total = totals[static_cast<std::size_t>(c)];
    EXPECT_NEAR(channel_sums(image)[static_cast<std::size_t>(c)] / total, 1, 1e-6);
  }
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
  restore_energy(outliers, loud(image), max_gain, image);
  expect_energy(before, image, outliers);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      ASSERT_NEAR(static_cast<double>(image.plane(3 + c)[i]) + static_cast<double>(image.plane(6 + c)[i]),
                  static_cast<double>(image.plane(c)[i]), 1e-6 * static_cast<double>(image.plane(c)[i]));
}

TEST(RestoreEnergy, AlphaStays) {
  Image image = smooth_image(4);
  const Image before = image;
  restore_energy({{30, 20, {5, 5, 5, 0}}}, loud(image), max_gain, image);
  for (std::size_t i = 0; i < image.pixels(); ++i) ASSERT_EQ(image.plane(3)[i], before.plane(3)[i]);
}

}  // namespace
}  // namespace polyrecon
