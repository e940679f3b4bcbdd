#include "blend/noise_bound.h"

#include <gtest/gtest.h>

#include "blend/select.h"
#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

using test::image_of;

double at(const Image& image, int x, int y, int c) { return static_cast<double>(image.at(x, y, c)); }

TEST(NoiseBound, IsFiveStandardDeviationsWhereNoiseIsAlikeAllOver) {
  const Image bound = noise_bound(Image(20, 15, 3, Real(0.04)));
  for (const auto& [x, y] : {std::pair{10, 7}, std::pair{0, 0}, std::pair{19, 14}})
    EXPECT_NEAR(at(bound, x, y, 1), 1, 1e-5);
  EXPECT_EQ(test::max_magnitude(noise_bound(Image(20, 15, 3))), 0);
  EXPECT_NEAR(at(noise_bound(Image(1, 1, 3, Real(0.04))), 0, 0, 2), 1, 1e-6);
}

/// Noise ends at an edge: pixels of the side with little noise have its bound, the others the bound of their own noise.
TEST(NoiseBound, NextToNoiseItIsThatOfTheLessNoisySide) {
  const Image bound = noise_bound(image_of(40, 20, 3, [](int x, int, int) { return x < 20 ? 1e-6 : 1; }));
  EXPECT_NEAR(at(bound, 19, 10, 0), 0.005, 1e-5);
  EXPECT_NEAR(at(bound, 20, 10, 0), 5, 1e-5);
}

/// A pixel without a spike among pixels of which some have one may be as wrong as these.
TEST(NoiseBound, AmongSpikesIsTheirs) {
  test::Random random(3);
  const Image bound = noise_bound(image_of(60, 60, 3, [&](int, int, int) { return random.uniform() < 0.2 ? 1 : 0; }));
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) EXPECT_GT(at(bound, x, y, 0), 0.1);
}

TEST(NoiseBound, TurnsWithTheImage) {
  test::Random random(4);
  const Image variance = image_of(23, 17, 3, [&](int, int, int) { return random.uniform(); });
  const auto transposed = [](const Image& image) {
    return image_of(image.height(), image.width(), 3, [&](int x, int y, int c) { return image.at(y, x, c); });
  };
  EXPECT_LT(test::max_difference(noise_bound(transposed(variance)), transposed(noise_bound(variance))), 1e-5);
}

struct Case {
  HalfPair pair;
  Candidate result;
};

/// Noisy halves of 1 + 0.1 and 1 - 0.1 with a layer of half of that and alpha, a result of 1.5 + 0.2 and 1.5 - 0.2.
Case make_case() {
  const auto image = [](double beauty) {
    return image_of(8, 6, 7, [&](int, int, int c) { return c == 6 ? 0.25 : c < 3 ? beauty : beauty / 2; });
  };
  Case out;
  out.pair.color = {image(1.1), image(0.9)};
  out.pair.variance = Image(8, 6, 3, Real(0.01));
  out.result = {{image(1.7), image(1.3)}, Image(8, 6, 3, Real(0.2)), Image(8, 6, 3), Image(8, 6, 1)};
  for (Image& half : out.result.half) std::fill(half.plane(6), half.plane(6) + half.pixels(), Real(0.75));
  return out;
}

TEST(BindToNoise, KeepsPixelsWithinTheBound) {
  Case c = make_case();
  const Candidate before = c.result;
  EXPECT_EQ(bind_to_noise(c.pair, Image(8, 6, 3, Real(0.51)), 10, c.result).pixels, 0u);
  for (std::size_t h = 0; h < 2; ++h) EXPECT_TRUE(test::same_bits(c.result.half[h], before.half[h]));
}

TEST(BindToNoise, MovesTheMeanToTheBound) {
  Case c = make_case();
  Image bound(8, 6, 3, Real(1));
  bound.at(3, 2, 1) = Real(0.25);  // half of the distance, in green
  const BoundEnergy lost = bind_to_noise(c.pair, bound, 10, c.result);
  EXPECT_EQ(lost.pixels, 1u);
  const std::vector<double> expected{0, 0.25, 0, 0, 0.125, 0};
  ASSERT_EQ(lost.energy.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(lost.energy[k], expected[k], 1e-6);
  EXPECT_NEAR(at(c.result.half[0], 3, 2, 1), 1.35, 1e-6);  // 1 + (1.7 - 1) / 2
  EXPECT_NEAR(at(c.result.half[1], 3, 2, 1), 1.15, 1e-6);
  EXPECT_NEAR(at(c.result.half[0], 3, 2, 4), 0.675, 1e-6);  // the layer's green by the same part
  EXPECT_NEAR(at(c.result.squared_bias, 3, 2, 1), 0.05, 1e-6);
  EXPECT_EQ(c.result.half[0].at(3, 2, 0), Real(1.7));
  EXPECT_EQ(c.result.half[0].at(3, 2, 6), Real(0.75));
  EXPECT_EQ(c.result.half[0].at(4, 2, 1), Real(1.7));
}

TEST(BindToNoise, WithoutNoiseTheInputStays) {
  Case c = make_case();
  EXPECT_EQ(bind_to_noise(c.pair, Image(8, 6, 3), 10, c.result).pixels, 48u);
  EXPECT_NEAR((at(c.result.half[0], 1, 1, 0) + at(c.result.half[1], 1, 1, 0)) / 2, 1, 1e-6);
}

TEST(BindToNoise, LosesNoMoreThanItMay) {
  Case c = make_case();
  const BoundEnergy lost = bind_to_noise(c.pair, Image(8, 6, 3), 0.1, c.result);  // the distance is half of the energy
  EXPECT_NEAR(lost.energy[0], 0.1 * 48, 1e-4);
  EXPECT_NEAR((at(c.result.half[0], 1, 1, 0) + at(c.result.half[1], 1, 1, 0)) / 2, 1.4, 1e-6);
}

TEST(BindToNoise, LayersThatAddUpStillDo) {
  test::Random random(5);
  const auto image = [&] {
    Image out(9, 7, 9);
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 9; ++x)
        for (int c = 0; c < 3; ++c) {
          out.at(x, y, 3 + c) = static_cast<Real>(random.uniform());
          out.at(x, y, 6 + c) = static_cast<Real>(random.uniform());
          out.at(x, y, c) = out.at(x, y, 3 + c) + out.at(x, y, 6 + c);
        }
    return out;
  };
  HalfPair pair;
  pair.color = {image(), image()};
  pair.variance = Image(9, 7, 3, Real(1e-3));
  Candidate result{{image(), image()}, Image(9, 7, 3), Image(9, 7, 3), Image(9, 7, 1)};
  EXPECT_GT(bind_to_noise(pair, noise_bound(pair.variance), 10, result).pixels, 30u);
  for (const Image& half : result.half)
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < half.pixels(); ++i)
        ASSERT_NEAR(static_cast<double>(half.plane(3 + c)[i]) + static_cast<double>(half.plane(6 + c)[i]),
                    static_cast<double>(half.plane(c)[i]), 1e-6);
}

}  // namespace
}  // namespace polyrecon
