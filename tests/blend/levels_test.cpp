#include "blend/levels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "blend/select.h"
#include "support/images.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

constexpr std::size_t plenty = std::size_t{1} << 30;

using test::image_of;

TEST(Downsample, AveragesColourAndQuartersTheVariance) {
  HalfPair pair = test::pair_of(Image(4, 2, 3, Real(1)), 0.5, 1);
  pair.features = {Image(4, 2, 1, Real(3)), Image(4, 2, 1, Real(5))};
  pair.epsilon = 0.2;
  const HalfPair half = downsample(pair);
  EXPECT_EQ(half.width(), 2);
  EXPECT_EQ(half.height(), 1);
  EXPECT_EQ(half.epsilon, 0.2);
  EXPECT_FLOAT_EQ(static_cast<float>(half.variance.at(1, 0, 2)), 0.0625f);  // 0.25 / 4
  EXPECT_EQ(half.features[1].at(0, 0, 0), Real(5));
  double mean = 0;
  for (int y = 0; y < 2; ++y)
    for (int x = 2; x < 4; ++x) mean += static_cast<double>(pair.color[1].at(x, y, 0)) / 4;
  EXPECT_NEAR(static_cast<double>(half.color[1].at(1, 0, 0)), mean, 1e-6);
}

double squared_error(const Candidate& candidate, const Image& truth) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < truth.pixels(); ++i) {
      const double f = 0.5 * (static_cast<double>(candidate.half[0].plane(c)[i]) +
                              static_cast<double>(candidate.half[1].plane(c)[i]));
      sum += (f - static_cast<double>(truth.plane(c)[i])) * (f - static_cast<double>(truth.plane(c)[i]));
    }
  return sum / (3.0 * static_cast<double>(truth.pixels()));
}

Candidate exact(const Image& value, const Image& error) {
  return {{value, value}, error, error, Image(value.width(), value.height(), 1, Real(2))};
}

TEST(AddCoarse, RemovesALowFrequencyErrorAndKeepsTheDetail) {
  const int size = 64;
  const Image truth = image_of(size, size, 3, [](int x, int y, int) { return 1 + 0.3 * ((x + y) % 2); });
  const HalfPair pair = test::pair_of(truth, 0.4, 2);
  const Image wrong = image_of(size, size, 3, [&](int x, int y, int c) {
    return static_cast<double>(truth.at(x, y, c)) + 0.2 * std::sin(0.1 * x);
  });
  const Image error = Image(size, size, 3, Real(0.5));
  const Candidate fine = exact(wrong, error),
                  coarse = exact(downsample(test::pair_of(truth, 0, 3)).color[0], Image(size / 2, size / 2, 3));
  const Candidate out = add_coarse(pair, fine, coarse, SelectParams{}, plenty);
  EXPECT_LT(squared_error(out, truth), 0.05 * squared_error(fine, truth));
  EXPECT_TRUE(test::same_bits(out.squared_bias, error));
  EXPECT_TRUE(test::same_bits(out.order, fine.order));
}

TEST(AddCoarse, AWorseCoarseResultIsNotAdded) {
  const int size = 64;
  const Image truth(size, size, 3, Real(1));
  const HalfPair pair = test::pair_of(truth, 0.1, 4);
  const Candidate fine = exact(truth, Image(size, size, 3));
  const Candidate coarse = exact(Image(size / 2, size / 2, 3, Real(1.5)), Image(size / 2, size / 2, 3));
  EXPECT_LT(test::max_difference(add_coarse(pair, fine, coarse, SelectParams{}, plenty).half[0], truth), 1e-3);
}

TEST(AddCoarse, WorksOnOddSizes) {
  const Image truth(33, 17, 3, Real(1));
  const HalfPair pair = test::pair_of(truth, 0.1, 5);
  const Candidate out = add_coarse(pair, exact(truth, Image(33, 17, 3)),
                                   exact(Image(17, 9, 3, Real(1)), Image(17, 9, 3)), SelectParams{}, plenty);
  EXPECT_LT(test::max_difference(out.half[1], truth), 1e-6);
}

}  // namespace
}  // namespace polyrecon
