#include "outliers/remove.h"

#include <gtest/gtest.h>

#include "core/color_layout.h"
#include "support/images.h"
#include "support/random.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

constexpr int size = 40;

/// A smooth image with a little noise in both halves, three colour channels and one AOV of half the brightness.
HalfPair noise_free_pair() {
  HalfPair pair = test::pair_of(
      test::image_of(size, size, 6, [](int x, int y, int c) { return (1 + 0.01 * x + 0.005 * y) * (c < 3 ? 1 : 0.5); }),
      0.02, 1);
  return pair;
}

/// A firefly: 50 times too bright in one half, with the variance that its samples have.
void put_spike(HalfPair& pair, std::size_t half, int x, int y, double value = 50) {
  for (int c = 0; c < ColorLayout(pair.color[half].channels()).layer_channels(); ++c)
    pair.color[half].at(x, y, c) = static_cast<Real>(c < 3 ? value : value / 2);
  for (int c = 0; c < 3; ++c) pair.variance.at(x, y, c) = static_cast<Real>(value * value / 2);
}

std::vector<Outlier> removed(HalfPair& pair, bool independent = true) {
  return remove_outliers(pair, {independent, true}, OutlierParams{}, silent_progress());
}

/// The list accounts for all energy that was taken: sum before = sum after + 2 x energy, as energy is that of the mean
/// of the halves.
void expect_balance(const HalfPair& before, const HalfPair& after, const std::vector<Outlier>& outliers) {
  for (int c = 0; c < before.color[0].channels(); ++c) {
    double sum = 0, energy = 0;
    for (std::size_t h = 0; h < 2; ++h) sum += test::sum_of(before.color[h], c) - test::sum_of(after.color[h], c);
    for (const Outlier& o : outliers) energy += o.energy[static_cast<std::size_t>(c)];
    EXPECT_NEAR(sum / 2, energy, 1e-6 * std::max(1.0, energy));
  }
}

TEST(RemoveOutliers, KeepNoise) {
  HalfPair pair = noise_free_pair();
  const HalfPair before = pair;
  EXPECT_TRUE(removed(pair).empty());
  EXPECT_TRUE(test::same_bits(pair.color[0], before.color[0]));
}

TEST(RemoveOutliers, FindASingleSpikeAnywhere) {
  for (const auto& [x, y] : {std::pair{20, 20}, std::pair{0, 0}, std::pair{size - 1, 17}, std::pair{5, size - 1},
                             std::pair{size - 1, size - 1}}) {
    HalfPair pair = noise_free_pair();
    put_spike(pair, 1, x, y);
    const HalfPair before = pair;
    const auto outliers = removed(pair);
    ASSERT_EQ(outliers.size(), 1u) << x << " " << y;
    EXPECT_EQ(outliers[0].x, x);
    EXPECT_EQ(outliers[0].y, y);
    EXPECT_NEAR(outliers[0].energy[0], 0.5 * (50 - (1 + 0.01 * x + 0.005 * y)), 0.1);
    EXPECT_NEAR(static_cast<double>(pair.color[1].at(x, y, 0)), 1 + 0.01 * x + 0.005 * y, 0.1);
    EXPECT_LT(pair.variance.at(x, y, 0), Real(0.001));
    EXPECT_TRUE(test::same_bits(pair.color[0], before.color[0]));
    expect_balance(before, pair, outliers);
  }
}

TEST(RemoveOutliers, ASpikeInBothHalvesStays) {
  HalfPair pair = noise_free_pair();
  put_spike(pair, 0, 20, 20);
  put_spike(pair, 1, 20, 20);
  for (int c = 0; c < 3; ++c) pair.variance.at(20, 20, c) = Real(1);  // the halves agree: a small lamp, well sampled
  EXPECT_TRUE(removed(pair).empty());
}

TEST(RemoveOutliers, AReliableSpikeStays) {
  HalfPair pair = noise_free_pair();
  put_spike(pair, 0, 20, 20);
  for (int c = 0; c < 3; ++c) pair.variance.at(20, 20, c) = Real(4);  // 49 above its neighbours, 24 standard deviations
  HalfPair of_estimated_variance = pair;
  EXPECT_TRUE(removed(pair).empty());
  const PairNoise estimated{true, false};
  EXPECT_EQ(remove_outliers(of_estimated_variance, estimated, OutlierParams{}, silent_progress()).size(), 1u);
}

TEST(RemoveOutliers, AdjacentSpikesBothGo) {
  HalfPair pair = noise_free_pair();
  put_spike(pair, 0, 20, 20);
  put_spike(pair, 0, 21, 20, 70);
  const HalfPair before = pair;
  const auto outliers = removed(pair);
  EXPECT_EQ(outliers.size(), 2u);
  EXPECT_LT(pair.color[0].at(20, 20, 0), Real(2));
  EXPECT_LT(pair.color[0].at(21, 20, 0), Real(2));
  expect_balance(before, pair, outliers);
}

TEST(RemoveOutliers, SpikesOnBlackGo) {
  HalfPair pair = test::pair_of(Image(size, size, 3), 0, 1);
  put_spike(pair, 0, 13, 7);
  const HalfPair before = pair;
  const auto outliers = removed(pair);
  ASSERT_EQ(outliers.size(), 1u);
  EXPECT_EQ(test::max_magnitude(pair.color[0]), 0);
  EXPECT_NEAR(outliers[0].energy[1], 25, 1e-9);
  expect_balance(before, pair, outliers);
}

/// A wall next to the pixel, six times as bright, hides the spike from a comparison of brightness, but not from a
/// comparison with the other half.
TEST(RemoveOutliers, ASpikeNextToAnEdgeIsReplaced) {
  HalfPair pair =
      test::pair_of(test::image_of(size, size, 3, [](int x, int, int) { return x < 21 ? 0.1 : 0.6; }), 0.002, 1);
  put_spike(pair, 1, 20, 20, 0.65);
  const HalfPair before = pair;
  const auto outliers = removed(pair);
  ASSERT_EQ(outliers.size(), 1u);
  EXPECT_EQ(outliers[0].x, 20);
  EXPECT_NEAR(static_cast<double>(pair.color[1].at(20, 20, 0)), 0.1,
              0.02);  // replaced by a pixel on the same side of the edge
  expect_balance(before, pair, outliers);
}

/// No neighbour is like the pixel of the other half, so none can replace the spike.
TEST(RemoveOutliers, ASpikeWithoutAnyLikeNeighbourStays) {
  HalfPair pair = test::pair_of(
      test::image_of(size, size, 3, [](int x, int y, int) { return x == 20 && y == 20 ? 0.1 : 0.6; }), 0.002, 1);
  put_spike(pair, 1, 20, 20, 0.6);
  EXPECT_TRUE(removed(pair).empty());
}

TEST(Case26, SpikesThatHoldTheEnergyStay) {
  // An interior lit by hidden lamps: one pixel in 20 of either half holds all the energy.
  HalfPair pair = test::pair_of(Image(size, size, 3), 0, 1);
  test::Random random(9);
  for (std::size_t h = 0; h < 2; ++h)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        if (random.uniform() < 0.05) put_spike(pair, h, x, y, 20 * (1 + random.uniform()));
  const HalfPair before = pair;
  double energy = 0;
  for (const Outlier& o : removed(pair)) energy += o.energy[0];
  const double total = 0.5 * (test::sum_of(before.color[0], 0) + test::sum_of(before.color[1], 0));
  // There are 18 in 19 x 19 pixels and 4.6 are allowed, so none is rare, except by chance in a corner.
  EXPECT_LT(energy, 0.02 * total);
}

TEST(RemoveOutliers, HalvesSplitFromOneImageAreNoEvidenceForEachOther) {
  HalfPair pair = noise_free_pair();
  put_spike(pair, 0, 20, 20, 50);
  put_spike(pair, 1, 20, 20, 55);
  const HalfPair before = pair;
  const auto outliers = removed(pair, false);
  EXPECT_EQ(outliers.size(), 2u);  // one in each half
  expect_balance(before, pair, outliers);
}

TEST(RemoveOutliers, AlphaIsNotTouched) {
  const Image truth =
      test::image_of(size, size, 4, [](int x, int y, int c) { return c < 3 ? 1 : ((x + y) % 7) / 7.0; });
  HalfPair pair = test::pair_of(truth, 0.02, 1);
  put_spike(pair, 0, 20, 20);
  const HalfPair before = pair;
  ASSERT_EQ(removed(pair).size(), 1u);
  EXPECT_EQ(pair.color[0].at(20, 20, 3), before.color[0].at(20, 20, 3));
}

TEST(RemoveOutliers, TinyImagesAreFine) {
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{1, 2}, std::pair{3, 1}, std::pair{2, 2}}) {
    HalfPair pair = test::pair_of(Image(w, h, 3, Real(1)), 0.1, 2);
    put_spike(pair, 0, 0, 0);
    const HalfPair before = pair;
    expect_balance(before, pair, {});
    const auto outliers = removed(pair);
    expect_balance(before, pair, outliers);
  }
}

}  // namespace
}  // namespace polyrecon
