#include "prior/mix.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

using test::image_of;

constexpr int size = 96;
constexpr double sigma = 0.3;  // of a half's noise

double truth(int x, int y) { return 1 + 0.4 * std::sin(0.2 * x) * std::cos(0.15 * y); }

/// Halves with independent noise.
HalfPair noisy_pair(std::uint64_t seed) {
  test::Random random(seed);
  const auto half = [&](int x, int y, int) { return truth(x, y) + sigma * random.normal(); };
  HalfPair pair;
  pair.color = {image_of(size, size, 3, half), image_of(size, size, 3, half)};
  pair.variance = image_of(size, size, 3, [](int, int, int) { return sigma * sigma; });
  pair.epsilon = 0.1;
  return pair;
}

/// The truth with an error of its own at each pixel.
Image with_error(double error, std::uint64_t seed) {
  test::Random random(seed);
  return image_of(size, size, 3, [&](int x, int y, int) { return truth(x, y) + error * random.normal(); });
}

double mean(const Image& image) { return test::sum_of(image, 0) / static_cast<double>(image.pixels()); }

TEST(ReconstructionShare, IsThatOfLeastError) {
  // Of two pictures with independent errors, the best mix gives each the share of the other's variance.
  for (const double ours : {0.05, 0.1, 0.2}) {
    constexpr double prior = 0.1;
    const ValidationHalves halves{{with_error(prior, 1), with_error(prior, 2)},
                                  {with_error(ours, 3), with_error(ours, 4)}};
    const double best = prior * prior / (prior * prior + ours * ours);
    EXPECT_NEAR(mean(reconstruction_share(noisy_pair(5), halves)), best, 0.05) << ours;
  }
}

TEST(ReconstructionShare, ANoisyPriorThatCopiesItsHalfIsLeftOut) {
  const HalfPair pair = noisy_pair(6);
  const ValidationHalves halves{pair.color, {with_error(0.05, 1), with_error(0.05, 2)}};
  EXPECT_GT(mean(reconstruction_share(pair, halves)), 0.93);
}

TEST(ReconstructionShare, ADarkPriorIsLeftOutThoughMostSamplesAreDarker) {
  // One sample in ten hits a light: it is ten times too bright, the others are black.
  test::Random random(7);
  const auto half = [&](int x, int y, int) { return random.uniform() < 0.1 ? 10 * truth(x, y) : 0.0; };
  HalfPair pair = noisy_pair(8);
  pair.color = {image_of(size, size, 3, half), image_of(size, size, 3, half)};
  const std::array<Image, 2> ours{with_error(0.2, 1), with_error(0.2, 2)};
  EXPECT_GT(mean(reconstruction_share(pair, {pair.color, ours})), 0.9) << "the samples themselves";
  const auto dark = [](int x, int y, int) { return 0.3 * truth(x, y); };
  const std::array<Image, 2> priors{image_of(size, size, 3, dark), image_of(size, size, 3, dark)};
  EXPECT_GT(mean(reconstruction_share(pair, {priors, ours})), 0.9) << "a dark picture";
}

TEST(ReconstructionShare, FollowsThePlace) {
  ValidationHalves halves{{with_error(0.02, 1), with_error(0.02, 2)}, {with_error(0.02, 3), with_error(0.02, 4)}};
  for (std::size_t h = 0; h < 2; ++h)
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) (x < size / 2 ? halves.prior : halves.ours)[h].at(x, y, c) += Real(0.2);
  const Image share = reconstruction_share(noisy_pair(7), halves);
  // Half way between the share of the place, 1 or 0, and that of the frame, as the pictures differ as much everywhere.
  EXPECT_GT(share.at(4, size / 2, 0), 0.6);
  EXPECT_LT(share.at(size - 5, size / 2, 0), 0.3);
}

TEST(ReconstructionShare, PicturesThatAreEqualGiveOurs) {
  const Image same = with_error(0.1, 1);
  const Image share = reconstruction_share(noisy_pair(8), {{same, same}, {same, same}});
  EXPECT_EQ(share.at(3, 3, 0), 1);
}

TEST(UnvalidatedShare, IsAQuarterLessTheNoiseThatWasKept) {
  const HalfPair pair = noisy_pair(9);
  const Image noisy = test::mean_of(pair.color[0], pair.color[1]);
  const Image prior = image_of(size, size, 3, [](int x, int y, int) { return truth(x, y); });
  for (const double kept : {0.0, 0.5, 1.0}) {
    const Image ours = image_of(size, size, 3, [&](int x, int y, int c) {
      return truth(x, y) + kept * (static_cast<double>(noisy.at(x, y, c)) - truth(x, y)) + 0.05;
    });
    EXPECT_NEAR(mean(unvalidated_share(pair, prior, ours)), 0.25 * (1 - kept), 0.002) << kept;
  }
}

TEST(MixWithPrior, TakesTheShareOfTheBeautyAlone) {
  Candidate ours = make_candidate(2, 2, 6);
  for (std::size_t h = 0; h < 2; ++h) ours.half[h] = Image(2, 2, 6, Real(h == 0 ? 4 : 8));
  const Candidate out = mix_with_prior(ours, Image(2, 2, 3, Real(2)), Image(2, 2, 1, Real(0.25)));
  EXPECT_EQ(out.half[0].at(1, 1, 2), 2.5);
  EXPECT_EQ(out.half[1].at(1, 1, 2), 3.5);
  EXPECT_EQ(out.half[1].at(1, 1, 3), 8);
}

TEST(FollowBeauty, LayersAddUpToTheNewOne) {
  test::Random random(10);
  Image layers(24, 16, 9);
  for (int c = 3; c < 9; ++c)
    for (std::size_t i = 0; i < layers.pixels(); ++i)
      layers.plane(c)[i] = i % 5 == 0 ? Real(0) : static_cast<Real>(random.uniform(-0.05, 1));
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < layers.pixels(); ++i)
      layers.plane(c)[i] = layers.plane(c + 3)[i] + layers.plane(c + 6)[i];
  const Image beauty = image_of(24, 16, 3, [&](int, int, int) { return random.uniform(0, 3); });
  const Image out = follow_beauty(layers, beauty);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i) {
      EXPECT_EQ(out.plane(c)[i], beauty.plane(c)[i]);
      EXPECT_NEAR(out.plane(c + 3)[i] + out.plane(c + 6)[i], beauty.plane(c)[i], 1e-5);
    }
}

TEST(FollowBeauty, ALayerKeepsItsPartOfTheBeauty) {
  Image layers(1, 1, 6);
  layers.at(0, 0, 0) = 2;
  layers.at(0, 0, 3) = Real(0.5);  // the other layers were not requested
  const Image out = follow_beauty(layers, Image(1, 1, 3, Real(3)));
  EXPECT_NEAR(out.at(0, 0, 3), 0.75, 1e-6);
}

}  // namespace
}  // namespace polyrecon
