#include "regression/order_selection.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "regression/least_squares.h"
#include "support/random.h"
#include "support/regression.h"

namespace polyrecon {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Random;
using test::stored;
using Channels = std::array<ColumnStatistics, 3>;

constexpr double eps = std::numeric_limits<Real>::epsilon();

/// A 7 x 7 window with two features and Taylor terms of order up to 2, three channels of a truth that no model holds,
/// noise that differs from pixel to pixel, and their factorisation by the code under test. All matrices have the
/// precision of storage.
struct Setting {
  static constexpr int n = 49;
  BasisLayout layout{2, 2};
  MatrixXd x, mu, variance, q;
  VectorXd w;
  Window window;
  std::vector<Real> weight;
  NestedFactor factor;

  explicit Setting(std::uint64_t seed) : x(n, layout.columns()), mu(n, 3), variance(n, 3), w(n) {
    Random random(seed);
    for (int j = 0; j < n; ++j) {
      const double dx = (j % 7 - 3) / 3.0, dy = (j / 7 - 3) / 3.0, f = random.uniform() - 0.5,
                   g = random.normal() * 0.3;
      x.row(j) << 1, f, g, dx, dy, dx * dx, dx * dy, dy * dy;
      w(j) = j % 5 == 0 ? 0 : random.uniform(0.05, 1);
      for (int c = 0; c < 3; ++c) {
        mu(j, c) = 1 + 0.4 * f - 0.2 * c * g + 0.3 * dx + 0.1 * std::sin(3 * dx + 2 * dy + c);
        variance(j, c) = 0.02 * (1 + random.uniform());
      }
    }
    x = stored(x);
    mu = stored(mu);
    w = stored(w);
    variance = stored(variance);
    window = test::window_of(x);
    weight = test::padded(w, window);
    factorise(window, layout.columns(), weight.data(), factor);
    q = test::q_of(factor, window);
  }

  /// Statistics of the three channels for a response and a guess, as fit_window would collect them.
  Channels statistics(const MatrixXd& y, const MatrixXd& guess, bool first_stage) {
    for (int c = 0; c < 3; ++c)
      for (int j = 0; j < n; ++j) {
        const auto at = static_cast<std::size_t>(c * window.stride + j);
        window.response[at] = static_cast<Real>(y(j, c));
        window.guess[at] = static_cast<Real>(guess(j, c));
        window.noise_variance[at] = static_cast<Real>(variance(j, c));
      }
    Channels channels;
    double *z[3], *guess_z[3], *s2[3];
    for (std::size_t c = 0; c < 3; ++c) {
      z[c] = channels[c].z.data();
      guess_z[c] = channels[c].guess.data();
      s2[c] = channels[c].variance.data();
      const auto k = static_cast<Eigen::Index>(c);
      const VectorXd m = (first_stage ? y : guess).col(k);
      channels[c].guess_energy = w.dot(m.cwiseAbs2());
      channels[c].noise_energy = w.dot(variance.col(k));
    }
    project_beauty(factor, window, weight.data(), true, z, guess_z, s2);
    return channels;
  }

  /// sum_i w_i bias(i)^2 of equation (5) with an explicit H.
  double bias_square(const MatrixXd& h, const VectorXd& m) const { return w.dot((h * m - m).cwiseAbs2()); }
  /// The same with the bias of y as one factor of the square.
  double bias_product(const MatrixXd& h, const VectorXd& y, const VectorXd& m) const {
    return w.dot((h * y - y).cwiseProduct(h * m - m));
  }
  /// sum_i w_i Var(yhat_i) of equation (6) with an explicit H.
  double variance_sum(const MatrixXd& h, int c) const { return w.dot(h.cwiseAbs2() * variance.col(c)); }
  /// What the noise in y adds to bias_square(H, y): sum_i w_i sum_j (H - I)_ij^2 sigma_j^2.
  double noise_in_bias(const MatrixXd& h, int c) const {
    return w.dot((h - MatrixXd::Identity(n, n)).cwiseAbs2() * variance.col(c));
  }
  /// H_g = S^-1 Q diag(g) Q^T S.
  MatrixXd shrunken(const VectorXd& g) const {
    return q.leftCols(g.size()) * g.asDiagonal() * q.leftCols(g.size()).transpose() * w.asDiagonal();
  }
};

/// The error without any column plus the changes by the first `columns` columns.
double nested_error(const ColumnStatistics& channel, int columns, const VectorXd& g, bool first_stage) {
  double error = channel.guess_energy - (first_stage ? channel.noise_energy : 0);
  for (int a = 0; a < columns; ++a) error += error_change(channel, a, g(a), first_stage);
  return error;
}

// Both sides are sums of terms of the size of |S mu|^2 (about 20 here); q is stored in Real.
constexpr double tolerance = 20 * 200 * eps;

TEST(ErrorChange, LaterStagesGiveBias5PlusVariance6OfEveryNestedModel) {
  Setting s(1);
  const Channels channels = s.statistics(s.mu, s.mu, false);
  for (int model = 0; model < s.layout.models(); ++model) {
    const int columns = s.layout.columns(model);
    const MatrixXd h = test::projection_matrix(s.x.leftCols(columns), s.w);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(nested_error(channels[static_cast<std::size_t>(c)], columns, VectorXd::Ones(columns), false),
                  s.bias_square(h, s.mu.col(c)) + s.variance_sum(h, c), tolerance)
          << "model " << model << ", channel " << c;
  }
}

TEST(ErrorChange, FirstStageSubtractsTheNoiseThatTheBiasOfTheNoisyDataHolds) {
  Setting s(2);
  Random random(20);
  MatrixXd y = s.mu;
  for (int c = 0; c < 3; ++c)
    for (int j = 0; j < Setting::n; ++j) y(j, c) += std::sqrt(s.variance(j, c)) * random.normal();
  y = stored(y);
  const Channels channels = s.statistics(y, y, true);
  for (int model = 0; model < s.layout.models(); ++model) {
    const int columns = s.layout.columns(model);
    const MatrixXd h = test::projection_matrix(s.x.leftCols(columns), s.w);
    for (int c = 0; c < 3; ++c) {
      const double expected = s.bias_square(h, y.col(c)) - s.noise_in_bias(h, c) + s.variance_sum(h, c);
      EXPECT_NEAR(nested_error(channels[static_cast<std::size_t>(c)], columns, VectorXd::Ones(columns), true), expected,
                  tolerance);
      // Another form: the noise to be subtracted is sum_j w_j sigma_j^2 (1 - h_j), with h_j the leverage.
      const double leverage_form =
          (s.w.cwiseProduct(s.variance.col(c))).dot((VectorXd::Ones(Setting::n) - h.diagonal()));
      EXPECT_NEAR(s.noise_in_bias(h, c), leverage_form, tolerance);
    }
  }
}

TEST(ErrorChange, HoldsForShrunkenColumnsToo) {
  Setting s(3);
  Random random(30);
  const MatrixXd noisy = stored(s.mu + 0.15 * test::normal_matrix(Setting::n, 3, random));
  for (const bool first_stage : {true, false}) {
    const MatrixXd& guess = first_stage ? noisy : s.mu;
    const Channels channels = s.statistics(guess, guess, first_stage);
    for (int model = 0; model < s.layout.models(); ++model) {
      const int columns = s.layout.columns(model);
      VectorXd g(columns);
      for (int a = 0; a < columns; ++a) g(a) = random.uniform(0, 1.2);
      const MatrixXd h = s.shrunken(g);
      for (int c = 0; c < 3; ++c) {
        const double expected =
            s.bias_square(h, guess.col(c)) - (first_stage ? s.noise_in_bias(h, c) : 0) + s.variance_sum(h, c);
        EXPECT_NEAR(nested_error(channels[static_cast<std::size_t>(c)], columns, g, first_stage), expected, tolerance);
      }
    }
  }
}

TEST(ShrinkageFactor, MinimisesTheSummedErrorChange) {
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    Channels channels;
    for (ColumnStatistics& channel : channels) {
      for (const std::size_t a : {1, 2}) {
        channel.z[a] = random.normal();
        channel.guess[a] = random.normal();
        channel.variance[a] = random.uniform(0, 2);
      }
    }
    for (const bool first_stage : {true, false}) {
      const auto change = [&](double g) {
        double sum = 0;
        for (const ColumnStatistics& channel : channels)
          sum += error_change(channel, 1, g, first_stage) + error_change(channel, 2, g, first_stage);
        return sum;
      };
      const double best = shrinkage_factor(channels, 1, 3, first_stage);
      EXPECT_GE(best, 0);
      EXPECT_LE(best, 1);
      for (int k = 0; k <= 100; ++k) EXPECT_LE(change(best), change(0.01 * k) + 1e-12) << first_stage << " " << k;
    }
  }
}

TEST(ShrinkageFactor, ByHand) {
  // Energy 1 + 4 + 4 = 9, noise 3 x 1: stage 1 keeps 1 - 3/9, later stages 9/(9 + 3); noise above energy keeps nothing.
  Channels channels;
  const double z[] = {1, 2, -2};
  for (std::size_t c = 0; c < 3; ++c) {
    channels[c].z[2] = channels[c].guess[2] = z[c];
    channels[c].variance[2] = 1;
    channels[c].z[3] = 0.1;
    channels[c].variance[3] = 1;
  }
  EXPECT_DOUBLE_EQ(shrinkage_factor(channels, 2, 3, true), 2.0 / 3);
  EXPECT_DOUBLE_EQ(shrinkage_factor(channels, 2, 3, false), 0.75);
  EXPECT_EQ(shrinkage_factor(channels, 3, 4, true), 0);
  EXPECT_EQ(shrinkage_factor(channels, 4, 5, true), 0);  // no energy at all: a dropped column
  EXPECT_EQ(shrinkage_factor(channels, 4, 5, false), 0);
  EXPECT_EQ(shrinkage_factor(channels, 0, 1, true), 1);  // the constant always enters whole
}

/// Factor of column a in the layout of Setting: features (1, 2) have a factor each, the Taylor terms of an order (3, 4
/// and 5 to 7) share one.
double group_factor(const Channels& channels, int a, bool first_stage) {
  const int begin[] = {0, 1, 2, 3, 3, 5, 5, 5}, end[] = {1, 2, 3, 5, 5, 8, 8, 8};
  return shrinkage_factor(channels, begin[a], end[a], first_stage);
}

TEST(SelectOrder, TakesTheModelOfLeastEstimatedErrorAndSaysHowLargeThatIs) {
  for (std::uint64_t seed = 40; seed < 60; ++seed) {
    Setting s(seed);
    Random random(seed * 7);
    const double noise = random.uniform(0.01, 0.4);
    s.variance.setConstant(static_cast<double>(static_cast<Real>(noise * noise)));
    const MatrixXd y = stored(s.mu + noise * test::normal_matrix(Setting::n, 3, random));
    for (const bool first_stage : {true, false}) {
      const MatrixXd& guess = first_stage ? y : s.mu;
      const Channels channels = s.statistics(y, guess, first_stage);
      const OrderChoice choice = select_order(channels, s.layout, s.w.sum(), first_stage, 0);
      // Outside of all columns the error is that of the guess.
      const MatrixXd whole = test::projection_matrix(s.x, s.w);
      // Brute force: every model's error with explicit projection matrices, the factors from their definition.
      double least = 1e300;
      int best = -1;
      std::array<double, 3> error{}, variance{};
      for (int model = 0; model < s.layout.models(); ++model) {
        VectorXd g(s.layout.columns(model));
        for (int a = 0; a < g.size(); ++a) g(a) = group_factor(channels, a, first_stage);
        const MatrixXd h = s.shrunken(g);
        double sum = 0;
        std::array<double, 3> e{}, v{};
        for (int c = 0; c < 3; ++c) {
          const auto k = static_cast<std::size_t>(c);
          v[k] = s.variance_sum(h, c);
          const double square = s.bias_square(h, guess.col(c));
          const double product = s.bias_product(h, y.col(c), guess.col(c)) + s.bias_square(whole, guess.col(c)) -
                                 s.bias_product(whole, y.col(c), guess.col(c));
          const double chosen_by = first_stage ? square - s.noise_in_bias(h, c) : product;
          const double squared_bias = first_stage ? chosen_by : 0.9 * product + 0.1 * square;
          sum += chosen_by + v[k];
          e[k] = std::max(squared_bias, 0.0) + v[k];
        }
        if (sum < least - 1e-9) {
          least = sum;
          best = model;
          error = e;
          variance = v;
        }
      }
      EXPECT_EQ(choice.model, best) << seed;
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(choice.error[c] * s.w.sum(), error[c], tolerance) << seed;
        EXPECT_NEAR(choice.variance[c] * s.w.sum(), variance[c], tolerance) << seed;
      }
      for (int a = 0; a < BasisLayout::max_columns; ++a)
        EXPECT_EQ(choice.factor[static_cast<std::size_t>(a)],
                  a < s.layout.columns(best) ? group_factor(channels, a, first_stage) : 0);
    }
  }
}

/// A layout without features, in which few columns differ from zero. The error change of later stages at the best
/// factor is -e^2/(e + n) per channel.
TEST(SelectOrder, AveragesModelsThatAreAsGoodWithinTheTolerance) {
  const BasisLayout layout(0, 2);
  Channels channels;
  for (ColumnStatistics& channel : channels) {
    channel.guess_energy = 100;
    channel.guess[0] = std::sqrt(50.0);  // the constant, also order 0, leaves 50
    channel.guess[1] = std::sqrt(10.0);  // order 1 leaves 40
    channel.guess[3] = std::sqrt(1.0);   // order 2 leaves 39
    channel.z = channel.guess;
  }
  const auto select = [&](double within) { return select_order(channels, layout, 2, false, within); };
  const OrderChoice best = select(0), near = select(0.02), both = select(0.05), all = select(0.5);
  EXPECT_EQ(best.model, 3);
  EXPECT_EQ(best.order, 2);
  EXPECT_DOUBLE_EQ(best.error[0], 39.0 / 2);
  EXPECT_EQ(best.variance[0], 0);
  EXPECT_EQ(near.factor, best.factor);  // 39 x 1.02 = 39.78 < 40
  // 39 x 0.05 = 1.95: order 1 is 1 / 1.95 of the tolerance above the best, so it counts 1 - 1/1.95.
  const double low = 1 - 1 / 1.95;
  EXPECT_DOUBLE_EQ(both.factor[1], 1);
  EXPECT_DOUBLE_EQ(both.factor[3], 1 / (1 + low));
  EXPECT_DOUBLE_EQ(both.order, (2 + low) / (1 + low));
  EXPECT_EQ(both.model, 3);
  // 19.5: the two models of the constant alone count 1 - 11/19.5 each.
  const double constant = 1 - 11 / 19.5, first = 1 - 1 / 19.5;
  EXPECT_DOUBLE_EQ(all.factor[0], 1);
  EXPECT_DOUBLE_EQ(all.factor[1], (1 + first) / (1 + first + 2 * constant));
  // The error of the average: 40, where order 2 enters with the factor g, so that (1 - g)^2 of its 1 is left.
  EXPECT_DOUBLE_EQ(both.error[0], (39 + std::pow(1 - both.factor[3], 2)) / 2);
}

/// The choice is continuous where the errors of two models cross.
TEST(SelectOrder, FollowsTheDataContinuously) {
  const BasisLayout layout(0, 2);
  for (const bool first_stage : {true, false}) {
    std::array<double, BasisLayout::max_columns> before{};
    for (int k = 0; k <= 20000; ++k) {
      Channels channels;
      for (ColumnStatistics& channel : channels) {
        channel.guess_energy = 60;
        channel.noise_energy = 6;
        channel.variance = {1, 1.1, 0.9, 1.2, 0.8, 1.3};
        channel.guess[0] = channel.z[0] = 5;
        channel.guess[1] = channel.z[1] = 1 + k * 1e-5 * 3;  // order 1 rises from below its noise,
        channel.guess[3] = channel.z[3] = 3 - k * 1e-5 * 6;  // order 2 sinks below it
      }
      const OrderChoice choice = select_order(channels, layout, 10, first_stage, 0.02);
      for (std::size_t a = 0; k > 0 && a < 6; ++a) ASSERT_NEAR(choice.factor[a], before[a], 0.01) << k << " " << a;
      before = choice.factor;
    }
  }
}

/// Mean over 1000 draws of the estimated error of each nested model against the true risk from an explicit H. The
/// mean of the estimates is normal to good approximation; 4 standard errors are exceeded by chance once in 16000, 12
/// comparisons.
TEST(Case25, EstimatedErrorIsUnbiasedOver1000Draws) {
  Setting s(70);
  Random random(71);
  const int draws = 1000, models = s.layout.models();
  MatrixXd sum = MatrixXd::Zero(models, 3), square = sum;
  for (int draw = 0; draw < draws; ++draw) {
    MatrixXd y = s.mu;
    for (int c = 0; c < 3; ++c)
      for (int j = 0; j < Setting::n; ++j) y(j, c) += std::sqrt(s.variance(j, c)) * random.normal();
    y = stored(y);
    const Channels channels = s.statistics(y, y, true);
    for (int model = 0; model < models; ++model)
      for (int c = 0; c < 3; ++c) {
        const double e = nested_error(channels[static_cast<std::size_t>(c)], s.layout.columns(model),
                                      VectorXd::Ones(s.layout.columns(model)), true);
        sum(model, c) += e;
        square(model, c) += e * e;
      }
  }
  for (int model = 0; model < models; ++model) {
    const MatrixXd h = test::projection_matrix(s.x.leftCols(s.layout.columns(model)), s.w);
    for (int c = 0; c < 3; ++c) {
      const double mean = sum(model, c) / draws, risk = s.bias_square(h, s.mu.col(c)) + s.variance_sum(h, c);
      const double standard_error = std::sqrt((square(model, c) / draws - mean * mean) / draws);
      EXPECT_LT(std::abs(mean - risk), 4 * standard_error) << "model " << model << ", channel " << c;
    }
  }
}

}  // namespace
}  // namespace polyrecon
