#include "presets/pareto.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace polyrecon {
namespace {

using Indices = std::vector<std::size_t>;

TEST(ParetoFront, KeepsWhatNothingBeatsInBoth) {
  //                                   fast, bad   beaten by 0   middle      slow, good  beaten by 3
  const std::vector<CostPoint> points{{1, 0.10}, {2, 0.11}, {2, 0.05}, {8, 0.01}, {9, 0.01}};
  EXPECT_EQ(pareto_front(points), (Indices{0, 2, 3}));
}

TEST(ParetoFront, OfEqualPointsOneIsEnough) {
  EXPECT_EQ(pareto_front({{1, 0.1}, {1, 0.1}, {1, 0.2}}), (Indices{0}));
  EXPECT_EQ(pareto_front({{1, 0.2}, {1, 0.1}}), (Indices{1}));  // as fast and better
}

TEST(ParetoFront, WhatCannotBeDrawnTakesNoPart) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  // relMSE is below zero where the reference is noisier than the result.
  EXPECT_EQ(pareto_front({{1, -0.1}, {nan, 0.1}, {1, nan}, {0, 0.1}, {3, 0.2}}), (Indices{4}));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(Price, FollowsAPowerLaw) {
  // error = 1 / seconds^2: an error of 0.9 needs 0.9^(-1/2) of the time, wherever the two points stand.
  EXPECT_NEAR(price_of_ten_percent({1, 1}, {2, 0.25}), std::pow(0.9, -0.5), 1e-12);
  EXPECT_NEAR(price_of_ten_percent({3, 1.0 / 9}, {30, 1.0 / 900}), std::pow(0.9, -0.5), 1e-12);
  // Just 10 % less for just twice the time.
  EXPECT_NEAR(price_of_ten_percent({1, 1}, {2, 0.9}), 2, 1e-12);
}

}  // namespace
}  // namespace polyrecon
