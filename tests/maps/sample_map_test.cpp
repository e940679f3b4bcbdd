#include "polyrecon/sample_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/parallel.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// An error map of the given variances and squared biases.
ErrorMap error_map(int width, int height, const std::vector<double>& variance, double bias2 = 0) {
  ErrorMap map;
  map.mse = Image(width, height, 3);
  map.relative_mse = map.relative_variance = Image(width, height, 1);
  for (std::size_t i = 0; i < variance.size(); ++i) {
    map.relative_variance.plane(0)[i] = static_cast<Real>(variance[i]);
    map.relative_mse.plane(0)[i] = static_cast<Real>(variance[i] + bias2);
  }
  return map;
}

ErrorMap random_map(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::lognormal_distribution<double> value(-4, 2);
  std::vector<double> variance(static_cast<std::size_t>(width * height));
  for (double& v : variance) v = value(random);
  return error_map(width, height, variance, 0.001);
}

Image filled(int width, int height, double value) { return {width, height, 1, static_cast<Real>(value)}; }

SampleMapParams budget_of(double budget, int radius = 3) {
  SampleMapParams params;
  params.budget = budget;
  params.radius = radius;
  return params;
}

SampleMap run(const ErrorMap& error, const SampleMapParams& params, const Image& counts = {}, const Image& cost = {}) {
  return make_sample_map(error, counts, cost, params, silent_progress());
}

TEST(SampleMap, TwoPixelsAreFilledAsWorkedOutByHand) {
  // Radius 0, n = 4, variances 4 and 1: dn_i = sqrt(V_i n_i) t - n_i = 4 t - 4 and 2 t - 4. A budget of 2 per pixel is
  // 4 in all: only the first gets any while t <= 2, and 4 t - 4 = 4 at t = 2, so dn = (4, 0). A budget of 5 is 10 in
  // all: 6 t - 8 = 10, t = 3, dn = (8, 2).
  const ErrorMap error = error_map(2, 1, {4, 1});
  const Image counts = filled(2, 1, 4);
  const SampleMap small = run(error, budget_of(2, 0), counts);
  EXPECT_NEAR(small.samples.at(0, 0, 0), 4, 1e-6);
  EXPECT_NEAR(small.samples.at(1, 0, 0), 0, 1e-6);
  const SampleMap large = run(error, budget_of(5, 0), counts);
  EXPECT_NEAR(large.samples.at(0, 0, 0), 8, 1e-6);
  EXPECT_NEAR(large.samples.at(1, 0, 0), 2, 1e-6);
  EXPECT_NEAR(large.importance.at(0, 0, 0), 1, 1e-7);
  EXPECT_NEAR(large.importance.at(1, 0, 0), 0.25, 1e-6);
  // (4 + 1) / 2 before; a pixel's share of it falls with n^-3/4.
  EXPECT_NEAR(large.error_before, 2.5, 1e-9);
  EXPECT_NEAR(large.error_after, (4 * std::pow(4. / 12, 0.75) + 1 * std::pow(4. / 6, 0.75)) / 2, 1e-6);
}

/// The greedy algorithm of the report: each quantum goes to the pixel that lowers the total error of all windows most
/// for its cost. Windows are explicit: K_ij of every pair of pixels, normalised over the i inside the image.
std::vector<double> greedy(const ErrorMap& error, const std::vector<double>& n, const std::vector<double>& cost,
                           double budget, double quantum, int radius) {
  const int w = error.relative_mse.width(), h = error.relative_mse.height();
  const std::size_t pixels = n.size();
  std::vector<std::vector<double>> k(pixels, std::vector<double>(pixels, 0.0));
  for (std::size_t j = 0; j < pixels; ++j) {
    double sum = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      const int dx = static_cast<int>(i) % w - static_cast<int>(j) % w;
      const int dy = static_cast<int>(i) / w - static_cast<int>(j) / w;
      if (std::abs(dx) > radius || std::abs(dy) > radius) continue;
      k[j][i] = radius > 0 ? std::exp(-2.0 * (dx * dx + dy * dy) / (radius * radius)) : 1.0;
      sum += k[j][i];
    }
    for (double& value : k[j]) value /= sum;
  }
  std::vector<double> extra(pixels, 0.0);
  double mean_cost = 0;
  for (const double c : cost) mean_cost += c / static_cast<double>(pixels);
  for (double spent = 0; spent < budget * static_cast<double>(w * h);) {
    std::size_t best = 0;
    double best_gain = -1;
    for (std::size_t i = 0; i < pixels; ++i) {
      const double drop = n[i] / (n[i] + extra[i]) - n[i] / (n[i] + extra[i] + quantum);
      double gain = 0;
      for (std::size_t j = 0; j < pixels; ++j) gain += error.relative_variance.plane(0)[j] * k[j][i] * drop;
      gain /= cost[i];
      if (gain > best_gain) best_gain = gain, best = i;
    }
    extra[best] += quantum;
    spent += quantum * cost[best] / mean_cost;
  }
  return extra;
}

TEST(SampleMap, IsTheEndOfAddingSamplesGreedily) {
  constexpr double quantum = 0.01;
  for (const int radius : {0, 1, 2}) {
    const ErrorMap error = random_map(5, 4, 17);
    std::vector<double> n(20), cost(20, 1.0);
    Image counts(5, 4, 1);
    for (std::size_t i = 0; i < n.size(); ++i) {
      n[i] = 2.0 + static_cast<double>(i % 5);
      counts.plane(0)[i] = static_cast<Real>(n[i]);
    }
    const std::vector<double> expected = greedy(error, n, cost, 6, quantum, radius);
    const SampleMap map = run(error, budget_of(6, radius), counts);
    // The greedy algorithm places whole quanta, so it may differ by one per pixel, and by one more for the last ones.
    for (std::size_t i = 0; i < n.size(); ++i)
      EXPECT_NEAR(map.samples.plane(0)[i], expected[i], 2.5 * quantum) << "radius " << radius << ", pixel " << i;
  }
}

TEST(SampleMap, CountsSecondsWhereTheCostIsKnown) {
  // Radius 0, so that the cost is not smoothed. n = 4, V = (4, 4), costs 1 and 4 (mean 2.5: 0.4 and 1.6).
  constexpr double quantum = 0.002;
  const ErrorMap error = error_map(2, 1, {4, 4});
  Image cost(2, 1, 1);
  cost.at(0, 0, 0) = 1;
  cost.at(1, 0, 0) = 4;
  const SampleMap map = run(error, budget_of(8, 0), filled(2, 1, 4), cost);
  const std::vector<double> expected = greedy(error, {4, 4}, {1, 4}, 8, quantum, 0);
  EXPECT_NEAR(map.samples.at(0, 0, 0), expected[0], 5 * quantum);
  EXPECT_NEAR(map.samples.at(1, 0, 0), expected[1], 5 * quantum);
  // The total cost is that of 8 samples of mean cost in both pixels.
  EXPECT_NEAR(1 * map.samples.at(0, 0, 0) + 4 * map.samples.at(1, 0, 0), 8 * 5, 1e-4);
  EXPECT_GT(map.samples.at(0, 0, 0), map.samples.at(1, 0, 0));
}

TEST(SampleMap, GoesByTheGeometricMeanOfErrorAndNoise) {
  // Radius 0, n = 4. sqrt(v u) = (2, 2) although v differs; where the noise is unknown, v decides.
  ErrorMap error = error_map(2, 1, {4, 1});
  error.relative_noise = Image(2, 1, 1);
  error.relative_noise.at(0, 0, 0) = 1;
  error.relative_noise.at(1, 0, 0) = 4;
  const SampleMap both = run(error, budget_of(5, 0), filled(2, 1, 4));
  EXPECT_NEAR(both.samples.at(0, 0, 0), 5, 1e-5);
  EXPECT_NEAR(both.samples.at(1, 0, 0), 5, 1e-5);
  EXPECT_NEAR(both.error_before, 2.5, 1e-6);  // whatever the weights are
  EXPECT_NEAR(both.error_after, 2.5 * std::pow(4. / 9, 0.75), 1e-5);
  error.relative_noise = Image(2, 1, 1);  // zero, so it is not used
  EXPECT_NEAR(run(error, budget_of(5, 0), filled(2, 1, 4)).samples.at(0, 0, 0), 8, 1e-5);
}

TEST(SampleMap, SpendsTheBudgetToOneInAMillion) {
  const ErrorMap error = random_map(61, 47, 3);
  for (const double budget : {0.01, 1.0, 32.0, 500.0}) {
    const SampleMap map = run(error, budget_of(budget));
    EXPECT_TRUE(map.limit_met);
    EXPECT_NEAR(map.total / (61 * 47), budget, 1e-6 * budget);
    EXPECT_LE(map.max, 1024);
    EXPECT_GE(map.min, 0);
    EXPECT_LT(map.error_after, map.error_before);
  }
}

TEST(SampleMap, ReachesTheTargetWithNoMoreThanItNeeds) {
  const ErrorMap error = random_map(40, 30, 5);
  SampleMapParams params;
  params.max_samples = 1e5;
  params.radius = budget_of(1).radius;
  params.target = run(error, budget_of(1)).error_before / 3;
  const SampleMap map = run(error, params);
  EXPECT_TRUE(map.limit_met);
  EXPECT_NEAR(map.error_after, params.target, 1e-9 * params.target);
  // The same samples given as a budget reach the same error.
  const SampleMap again = run(error, budget_of(map.total / (40 * 30)));
  EXPECT_NEAR(again.error_after, params.target, 1e-6 * params.target);
}

TEST(SampleMap, ATargetAlreadyReachedNeedsNoSamples) {
  SampleMapParams params;
  params.target = 1;
  const SampleMap map = run(error_map(3, 3, std::vector<double>(9, 0.5)), params);
  EXPECT_TRUE(map.limit_met);
  EXPECT_EQ(map.total, 0);
}

TEST(SampleMap, TheBiasFallsAsTheVarianceDoes) {
  // Four times the samples everywhere, half of the error is bias: (1/4)^(3/4) of all of it is left.
  const SampleMap map = run(error_map(9, 5, std::vector<double>(45, 0.2), 0.2), budget_of(24, 0), filled(9, 5, 8));
  EXPECT_NEAR(map.error_before, 0.4, 1e-6);
  EXPECT_NEAR(map.error_after, 0.4 * std::pow(0.25, 0.75), 1e-6);
}

TEST(SampleMap, ATargetBeyondTheMostSamplesIsReportedAsNotMet) {
  SampleMapParams params;
  params.target = 0.1;
  params.max_samples = 50;
  const SampleMap map = run(error_map(3, 3, std::vector<double>(9, 0.5), 0.2), params);
  EXPECT_FALSE(map.limit_met);
  EXPECT_NEAR(map.error_after, 0.7 * std::pow(8. / 58, 0.75), 1e-6);
  EXPECT_EQ(map.max, 50);  // still limited, so that a loop continues with a finite pass
}

TEST(SampleMap, GrowsWithTheVarianceAndWithTheBudget) {
  std::vector<double> variance(16);
  for (std::size_t i = 0; i < variance.size(); ++i) variance[i] = 0.01 * static_cast<double>(i * i);
  const ErrorMap error = error_map(16, 1, variance);
  const SampleMap small = run(error, budget_of(4, 0)), large = run(error, budget_of(8, 0));
  for (int x = 0; x < 16; ++x) {
    if (x > 0) {
      EXPECT_GE(small.samples.at(x, 0, 0), small.samples.at(x - 1, 0, 0));
    }
    EXPECT_GE(large.samples.at(x, 0, 0), small.samples.at(x, 0, 0));
  }
  EXPECT_EQ(small.samples.at(0, 0, 0), 0);
  EXPECT_LT(large.error_after, small.error_after);
}

TEST(SampleMap, GivesNothingWhereNoWindowHasAnError) {
  std::vector<double> variance(21 * 21, 0.0);
  variance[10 * 21 + 10] = 1;  // one pixel in the middle, window radius 3
  const SampleMap map = run(error_map(21, 21, variance), budget_of(0.5));
  EXPECT_NEAR(map.total, 0.5 * 21 * 21, 1e-3);
  for (int y = 0; y < 21; ++y)
    for (int x = 0; x < 21; ++x)
      if (std::abs(x - 10) > 3 || std::abs(y - 10) > 3) {
        EXPECT_EQ(map.samples.at(x, y, 0), 0) << x << ", " << y;
      }
  EXPECT_EQ(map.importance.at(10, 10, 0), 1);
}

TEST(SampleMap, AllZeroErrorEndsTheLoop) {
  const SampleMap map = run(error_map(4, 3, std::vector<double>(12, 0.0)), budget_of(32));
  EXPECT_EQ(map.total, 0);
  EXPECT_EQ(map.max, 0);
  EXPECT_EQ(map.importance.at(2, 1, 0), 0);
  EXPECT_FALSE(map.limit_met);
}

TEST(SampleMap, OnePixelTakesTheWholeBudget) {
  const SampleMap map = run(error_map(1, 1, {0.3}), budget_of(32));
  EXPECT_NEAR(map.samples.at(0, 0, 0), 32, 1e-4);
}

TEST(SampleMap, EqualErrorsEverywhereGiveAUniformMap) {
  const SampleMap map = run(error_map(9, 5, std::vector<double>(45, 0.2)), budget_of(16, 0));
  EXPECT_NEAR(map.min, 16, 1e-4);
  EXPECT_NEAR(map.max, 16, 1e-4);
}

TEST(SampleMap, ABudgetTheErrorCannotTakeIsNotForcedUponIt) {
  // One noisy pixel, radius 0: at most max_samples go there, the other pixels have nothing to gain.
  std::vector<double> variance(100, 0.0);
  variance[5] = 1;
  SampleMapParams params = budget_of(8, 0);
  params.max_samples = 100;
  const SampleMap map = run(error_map(10, 10, variance), params);
  EXPECT_EQ(map.total, 100);
  EXPECT_FALSE(map.limit_met);
}

TEST(SampleMap, NotANumberCountsAsTheMeanOfTheRest) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const SampleMap map = run(error_map(4, 1, {0.1, nan, 0.3, inf}), budget_of(8, 0));
  EXPECT_EQ(map.unknown_pixels, 2u);
  const SampleMap mean = run(error_map(4, 1, {0.1, 0.2, 0.3, 0.2}), budget_of(8, 0));
  for (int x = 0; x < 4; ++x) EXPECT_NEAR(map.samples.at(x, 0, 0), mean.samples.at(x, 0, 0), 1e-4);
}

TEST(SampleMap, NothingFiniteIsSpreadEvenlyOrRefusedForATarget) {
  const ErrorMap error = error_map(3, 2, std::vector<double>(6, std::numeric_limits<double>::quiet_NaN()));
  const SampleMap map = run(error, budget_of(8, 0));
  EXPECT_EQ(map.unknown_pixels, 6u);
  EXPECT_NEAR(map.min, 8, 1e-4);
  SampleMapParams params;
  params.target = 0.1;
  EXPECT_THROW(run(error, params), Error);
}

TEST(SampleMap, HugeAndTinyErrorsStayFinite) {
  const SampleMap map = run(error_map(4, 1, {1e30, 1e-30, 1e-8, 1e6}), budget_of(10, 1));
  for (int x = 0; x < 4; ++x) EXPECT_TRUE(std::isfinite(map.samples.at(x, 0, 0)));
  EXPECT_NEAR(map.total, 40, 1e-4);
}

TEST(SampleMap, BadCountsAndCostsAreReplaced) {
  Image counts = filled(3, 1, 8), cost = filled(3, 1, 2);
  counts.at(0, 0, 0) = 0;
  counts.at(1, 0, 0) = std::numeric_limits<Real>::quiet_NaN();
  cost.at(2, 0, 0) = -1;
  const SampleMap map = run(error_map(3, 1, {0.1, 0.1, 0.1}), budget_of(8, 0), counts, cost);
  EXPECT_EQ(map.samples.at(0, 0, 0), map.samples.at(1, 0, 0));
  EXPECT_NEAR(map.total, 24, 1e-4);
}

TEST(SampleMap, HasTheSameBitsForAnyNumberOfThreads) {
  const ErrorMap error = random_map(97, 61, 11);
  set_thread_limit(1);
  const SampleMap one = run(error, budget_of(16));
  set_thread_limit(0);
  const SampleMap all = run(error, budget_of(16));
  for (std::size_t i = 0; i < one.samples.pixels(); ++i) ASSERT_EQ(one.samples.plane(0)[i], all.samples.plane(0)[i]);
  EXPECT_EQ(one.error_after, all.error_after);
}

TEST(SampleMap, ContradictionsAreUsageErrors) {
  const ErrorMap error = error_map(1, 1, {1});
  SampleMapParams both = budget_of(1);
  both.target = 0.1;
  SampleMapParams capped = budget_of(100);
  capped.max_samples = 10;
  for (const SampleMapParams& params : {SampleMapParams{}, both, capped, budget_of(-1), budget_of(1, -1)}) {
    try {
      run(error, params);
      FAIL() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::Usage);
    }
  }
}

TEST(SampleMap, OtherSizesAreBadInput) {
  EXPECT_THROW(run(error_map(2, 1, {1, 1}), budget_of(1), filled(1, 2, 4)), Error);
  EXPECT_THROW(run(error_map(2, 1, {1, 1}), budget_of(1), {}, filled(3, 1, 4)), Error);
}

}  // namespace
}  // namespace polyrecon
