#include "pipeline/noisy_halves.h"

#include <gtest/gtest.h>

#include "polyrecon/reconstruct.h"
#include "support/scene.h"
#include "temporal/neighbour.h"

namespace polyrecon {
namespace {

class NoisyHalvesOf : public ::testing::TestWithParam<HalvesFor> {
 protected:
  NoisyHalves made(HalvesFor purpose, Frame frame) const {
    Report report;
    Phases phases(silent_progress(), report);
    return make_noisy_halves(frame, purpose, 3 * streams_per_frame, Params(), phases);
  }
};

/// The right half of the frame was not rendered.
Frame half_of_a_frame() {
  Frame frame = test::make_scene(64, 48, 0.3, 1).frame;
  const auto clear = [](Image& image) {
    for (int c = 0; c < image.channels(); ++c)
      for (int y = 0; y < image.height(); ++y)
        for (int x = 32; x < image.width(); ++x) image.at(x, y, c) = 0;
  };
  frame.alpha = Image(64, 48, 1, 1);
  for (Image* image :
       {&frame.alpha, &frame.beauty.mean, &frame.beauty.variance, &frame.beauty.half_a, &frame.beauty.half_b})
    clear(*image);
  for (Feature& feature : frame.features) clear(feature.pass.mean);
  return frame;
}

/// Whatever the halves are made for, the steps are the same ones in the same order.
TEST_P(NoisyHalvesOf, ColoursAndNoiseDoNotDependOnThePurpose) {
  for (const bool measured : {true, false}) {
    Frame frame = half_of_a_frame();
    if (!measured) frame.beauty.variance = frame.beauty.half_a = frame.beauty.half_b = {};
    const NoisyHalves alone = made(HalvesFor::Fit, frame), other = made(GetParam(), frame);
    EXPECT_FALSE(alone.prepared.pair.sampled.empty());
    EXPECT_TRUE(test::same_bits(other.prepared.pair.sampled, alone.prepared.pair.sampled));
    EXPECT_TRUE(test::same_bits(other.prepared.pair.variance, alone.prepared.pair.variance));
    for (std::size_t h = 0; h < 2; ++h)
      EXPECT_TRUE(test::same_bits(other.prepared.pair.color[h], alone.prepared.pair.color[h]));
    EXPECT_FALSE(other.geometry.surface[index_of(Surface::Distance)].empty());
    EXPECT_TRUE(alone.geometry.surface[index_of(Surface::Distance)].empty());
  }
}

INSTANTIATE_TEST_SUITE_P(ForNeighbours, NoisyHalvesOf,
                         ::testing::Values(HalvesFor::FitWithNeighbours, HalvesFor::Neighbour));

TEST(NoisyHalves, OfANeighbourHaveNoFeaturesAndNoBound) {
  Report report;
  Phases phases(silent_progress(), report);
  Frame frame = test::make_scene(48, 32, 0.3, 1).frame;
  const NoisyHalves halves = make_noisy_halves(frame, HalvesFor::Neighbour, 0, Params(), phases);
  EXPECT_EQ(halves.prepared.pair.features[0].channels(), 0);
  EXPECT_TRUE(halves.prepared.pair.bound.empty());
}

}  // namespace
}  // namespace polyrecon
