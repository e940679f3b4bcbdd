#include "noise/spike_variance.h"

#include <gtest/gtest.h>

#include "support/images.h"

namespace polyrecon {
namespace {

using test::image_of;

constexpr int size = 40;

/// Half of the square of the excess of 8 over 1, less what rounding of both to half floats may contribute.
constexpr double of_six = 0.5 * (6 - 0x1p-11 * 8) * (6 - 0x1p-11 * 8);

/// Background 1 and spikes of the given height at every `step`-th pixel of both directions.
Image with_spikes(int step, double height) {
  return image_of(size, size, 3, [&](int x, int y, int) { return x % step == 2 && y % step == 2 ? 1 + height : 1; });
}

TEST(SpikeVariance, IsHalfTheSquareOfWhatSpikesExceedTheirNeighboursBy) {
  const Image out = spike_variance(with_spikes(5, 6));
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      EXPECT_FLOAT_EQ(static_cast<float>(out.at(x, y, 1)), x % 5 == 2 && y % 5 == 2 ? static_cast<float>(of_six) : 0)
          << x << " " << y;
}

TEST(SpikeVariance, AGlintAloneIsNoNoise) {
  Image image(size, size, 3, Real(1));
  image.at(20, 20, 0) = Real(1000);
  EXPECT_TRUE(test::same_bits(spike_variance(image), Image(size, size, 3)));
}

TEST(SpikeVariance, AGlintAmongSpikesCountsLikeThem) {
  Image image = with_spikes(5, 6);
  image.at(22, 22, 0) = Real(1000);
  EXPECT_FLOAT_EQ(static_cast<float>(spike_variance(image).at(22, 22, 0)), static_cast<float>(of_six));
}

TEST(SpikeVariance, LinesAndSlopesAreNoSpikes) {
  EXPECT_TRUE(test::same_bits(
      spike_variance(image_of(size, size, 3, [](int x, int y, int) { return x == y       ? 5
                                                                            : x % 4 == 0 ? 3
                                                                                         : 1; })),
      Image(size, size, 3)));
  EXPECT_TRUE(test::same_bits(spike_variance(image_of(size, size, 3, [](int x, int y, int) { return x + 2 * y; })),
                              Image(size, size, 3)));
}

TEST(SpikeVariance, OfTinyImagesIsZero) {
  for (const int n : {1, 2, 9}) {
    Image image(n, n, 3);
    image.at(n - 1, n - 1, 2) = Real(3);
    EXPECT_TRUE(test::same_bits(spike_variance(image), Image(n, n, 3))) << n;
  }
}

}  // namespace
}  // namespace polyrecon
