#include "regression/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "support/random.h"
#include "support/regression.h"

namespace polyrecon {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::design_with_constant;
using test::eps;
using test::normal_matrix;
using test::orthonormality_error;
using test::Problem;
using test::Random;
using test::random_weights;
using test::stored;

TEST(Factorise, ColumnsAreOrthonormalUnderTheWeights) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const Problem p(design_with_constant(81, 15, random), random_weights(81, 0.3, random));
    EXPECT_EQ(p.factor.rank, 15);
    EXPECT_LT(orthonormality_error(p), 81 * eps);
  }
}

TEST(Factorise, EveryPrefixIsTheWeightedLeastSquaresFitOfAllModelsAtOnce) {
  Random random(2);
  for (int round = 0; round < 10; ++round) {
    const Problem p(design_with_constant(49, 12, random), random_weights(49, 0.3, random));
    const VectorXd y = stored(normal_matrix(49, 1, random)), z = p.coefficients(y), s = p.w.cwiseSqrt();
    const MatrixXd q = p.q();
    for (int columns = 1; columns <= 12; ++columns) {
      const MatrixXd x = p.x.leftCols(columns), sx = s.asDiagonal() * x;
      const VectorXd expected = x * sx.colPivHouseholderQr().solve(s.asDiagonal() * y);
      const VectorXd fit = q.leftCols(columns) * z.head(columns);
      // The fit extrapolates to pixels of weight zero, which amplifies rounding, so the error is relative to the
      // largest value of the fit.
      EXPECT_LT((fit - expected).cwiseAbs().maxCoeff(), 100 * eps * expected.cwiseAbs().maxCoeff())
          << round << " " << columns;
    }
  }
}

TEST(Factorise, ProjectionMatrixIsThatOfEquations5And6) {
  Random random(3);
  const Problem p(design_with_constant(49, 9, random), random_weights(49, 0.25, random));
  const MatrixXd q = p.q(), expected = test::projection_matrix(p.x, p.w);
  const MatrixXd h = q * q.transpose() * p.w.asDiagonal();
  EXPECT_LT((h - expected).cwiseAbs().maxCoeff(), 100 * eps * expected.cwiseAbs().maxCoeff());
  EXPECT_NEAR(h.trace(), p.factor.rank, 49 * eps * 9);
  EXPECT_LT((h * h - h).cwiseAbs().maxCoeff(), 100 * eps * expected.cwiseAbs().maxCoeff());
}

/// A feature that is rounding where weights are positive, and large where they are zero, must not be fitted to the
/// rounding.
TEST(Factorise, AFeatureThatVariesOnlyWhereWeightsAreZeroIsDropped) {
  for (const double elsewhere : {1e-7, 1e-2, 1.0}) {
    Random random(4);
    MatrixXd x = design_with_constant(49, 2, random);
    VectorXd w = random_weights(49, 0, random);
    x.col(1) = 1e-7 * normal_matrix(49, 1, random);
    x.col(1).tail(9).array() += elsewhere;
    Window window = test::window_of(x);
    window.layout = BasisLayout(1, 0);
    const auto kept = [&](double weight_there) {
      w.tail(9).setConstant(weight_there);
      NestedFactor factor;
      factorise(window, 2, test::padded(w, window).data(), factor);
      return test::keeps(factor, 1);
    };
    EXPECT_FALSE(kept(1e-12)) << elsewhere;
    EXPECT_EQ(kept(1), elsewhere > 1e-6) << elsewhere;
  }
}

TEST(Factorise, PixelsOfWeightZeroHaveNoEffect) {
  Random random(6);
  MatrixXd x = design_with_constant(49, 6, random);
  VectorXd w = random_weights(49, 0.5, random), y = normal_matrix(49, 1, random);
  const Problem p(x, w);
  const VectorXd z = p.coefficients(y);
  for (int j = 0; j < 49; ++j)
    if (w(j) == 0) {
      x.row(j) *= 1000;
      y(j) = -1e6;
    }
  const Problem changed(x, w);
  EXPECT_EQ((changed.coefficients(y) - z).cwiseAbs().maxCoeff(), 0);
}

TEST(Factorise, NoWeightAtAllLeavesNothing) {
  Random random(7);
  const Problem p(design_with_constant(25, 4, random), VectorXd::Zero(25));
  EXPECT_EQ(p.factor.rank, 0);
  EXPECT_EQ(p.q().cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(p.coefficients(VectorXd::Ones(25)).cwiseAbs().maxCoeff(), 0);
}

TEST(Factorise, OnePixelOfWeightCarriesTheConstantAlone) {
  Random random(8);
  VectorXd w = VectorXd::Zero(25);
  w(7) = 0.25;
  const Problem p(design_with_constant(25, 5, random), w);
  EXPECT_EQ(p.factor.rank, 1);
  EXPECT_EQ(p.factor.kept, 1);
  VectorXd y = VectorXd::Zero(25);
  y(7) = 3;
  // q_0 = 1/sqrt(w) = 2 everywhere, z_0 = w q y = 1.5: the fit is 3 at every pixel.
  EXPECT_NEAR(p.coefficients(y)(0), 1.5, 1e-6);
  EXPECT_NEAR(p.q()(3, 0), 2, 1e-6);
}

/// Column 4 is the hard one; column 0 is the constant, and 1 to 3 and 5 are ordinary.
struct HardColumn {
  const char* name;
  VectorXd (*column)(const MatrixXd& ordinary, Random& random);
  bool kept;
};

const HardColumn hard_columns[] = {
    {"zero", [](const MatrixXd& x, Random&) -> VectorXd { return VectorXd::Zero(x.rows()); }, false},
    {"constant", [](const MatrixXd& x, Random&) -> VectorXd { return VectorXd::Constant(x.rows(), 0.7); }, false},
    {"duplicate", [](const MatrixXd& x, Random&) -> VectorXd { return x.col(2); }, false},
    {"sum of two", [](const MatrixXd& x, Random&) -> VectorXd { return x.col(1) - 2 * x.col(3); }, false},
    {"collinear to 1e-8",
     [](const MatrixXd& x, Random& r) -> VectorXd {
       return x.col(2) + 1e-8 * normal_matrix(static_cast<int>(x.rows()), 1, r);
     },
     false},
    {"1e10",
     [](const MatrixXd& x, Random& r) -> VectorXd { return 1e10 * normal_matrix(static_cast<int>(x.rows()), 1, r); },
     true},
    {"1e-10",
     [](const MatrixXd& x, Random& r) -> VectorXd { return 1e-10 * normal_matrix(static_cast<int>(x.rows()), 1, r); },
     true},
    {"mostly sky",
     [](const MatrixXd& x, Random&) -> VectorXd {
       VectorXd c = x.col(1);
       c.head(20).setConstant(1e10);
       return c;
     },
     true},
};

TEST(Factorise, HardColumnsAreFiniteAndTheRankIsRight) {
  for (const HardColumn& hard : hard_columns) {
    SCOPED_TRACE(hard.name);
    Random random(9);
    MatrixXd x = design_with_constant(49, 6, random);
    x.col(4) = hard.column(x, random);
    const Problem p(x, random_weights(49, 0.2, random));
    EXPECT_TRUE(p.q().allFinite());
    EXPECT_EQ(test::keeps(p.factor, 4), hard.kept);
    EXPECT_EQ(p.factor.rank, hard.kept ? 6 : 5);
    EXPECT_LT(orthonormality_error(p), 1000 * eps);
    const VectorXd y = stored(normal_matrix(49, 1, random));
    EXPECT_TRUE(p.coefficients(y).allFinite());
  }
}

TEST(Factorise, DenormalColumnsAreFinite) {
  // A column of 1e-40: its samples hold a few bits only, so it may stay or go, but nothing may overflow.
  for (const double size : {1e-36, 1e-39, 1e-41, 1.5e-45}) {
    Random random(10);
    MatrixXd x = design_with_constant(49, 5, random);
    x.col(3) *= size;
    const Problem p(x, random_weights(49, 0.2, random));
    EXPECT_TRUE(p.q().allFinite()) << size;
    EXPECT_LT(orthonormality_error(p), 1000 * eps) << size;
    EXPECT_GE(p.factor.rank, 4) << size;
  }
}

/// The deviation from the ridge regression is largest where little is left of a column.
TEST(Factorise, NearlyDependentColumnsStayOrthogonal) {
  for (const double part : {0.3, 0.1, 0.03, 0.02}) {
    Random random(11);
    MatrixXd x = design_with_constant(81, 6, random);
    x.col(4) = x.col(2) + x.col(3) + part * normal_matrix(81, 1, random);
    const Problem p(x, random_weights(81, 0.2, random));
    EXPECT_TRUE(test::keeps(p.factor, 4)) << part;
    EXPECT_LT(orthonormality_error(p), 1000 * eps) << part;
  }
}

/// A feature that turns into a duplicate of another one fades out continuously, and so do the fits with columns after
/// it.
TEST(Factorise, AColumnFadesOutContinuously) {
  Random random(13);
  const MatrixXd ordinary = design_with_constant(49, 6, random), independent = normal_matrix(49, 1, random);
  const VectorXd w = random_weights(49, 0, random), y = stored(normal_matrix(49, 1, random));
  const auto fit = [&](double part) -> VectorXd {
    MatrixXd x = ordinary;
    x.col(3) = x.col(2) + part * independent;
    const Problem p(x, w);
    return p.q() * p.coefficients(y);
  };
  const double largest = fit(1).cwiseAbs().maxCoeff();
  VectorXd before = fit(1);
  double path = 0;
  for (double part = 1; part > 1e-6; part *= 0.98) {
    const VectorXd now = fit(part);
    const double step = (now - before).cwiseAbs().maxCoeff();
    EXPECT_LT(step, 0.03 * largest) << part;
    path += step;
    before = now;
  }
  EXPECT_GT(path, 0.01 * largest);  // the fit does change
}

TEST(Factorise, IsTheRidgeRegressionOfItsPenalties) {
  Random random(14);
  for (int round = 0; round < 20; ++round) {
    MatrixXd x = design_with_constant(49, 7, random);
    x.col(4) = x.col(1) + random.uniform(0.01, 0.2) * normal_matrix(49, 1, random);
    const Problem p(x, random_weights(49, 0.3, random));
    const MatrixXd expected = test::penalised(p.x, p.w, {}, 0).q;
    EXPECT_LT((p.q() - expected).cwiseAbs().maxCoeff(), 2000 * eps * expected.cwiseAbs().maxCoeff());
  }
}

TEST(ProjectBeauty, IsProjectOfEachChannelAndTheVarianceOfItsCoefficients) {
  Random random(12);
  const MatrixXd x = design_with_constant(49, 8, random);
  Problem p(x, random_weights(49, 0.3, random));
  MatrixXd y = stored(normal_matrix(49, 3, random)), guess = stored(normal_matrix(49, 3, random));
  MatrixXd variance = stored(normal_matrix(49, 3, random).cwiseAbs2());
  for (int c = 0; c < 3; ++c)
    for (int j = 0; j < 49; ++j) {
      const auto at = static_cast<std::size_t>(c * p.window.stride + j);
      p.window.response[at] = static_cast<Real>(y(j, c));
      p.window.guess[at] = static_cast<Real>(guess(j, c));
      p.window.noise_variance[at] = static_cast<Real>(variance(j, c));
    }
  double sums[9][BasisLayout::max_columns];
  double *z[3] = {sums[0], sums[1], sums[2]}, *guess_z[3] = {sums[3], sums[4], sums[5]},
         *s2[3] = {sums[6], sums[7], sums[8]};
  project_beauty(p.factor, p.window, p.weight.data(), true, z, guess_z, s2);
  // z = Q^T S S^-1 ... of y with noise of covariance D has covariance (w q)^T D (w q).
  const MatrixXd wq = p.w.asDiagonal() * p.q();
  for (int c = 0; c < 3; ++c)
    for (int a = 0; a < 8; ++a) {
      EXPECT_NEAR(z[c][a], wq.col(a).dot(y.col(c)), 1e-12);
      EXPECT_NEAR(guess_z[c][a], wq.col(a).dot(guess.col(c)), 1e-12);
      EXPECT_NEAR(s2[c][a], wq.col(a).cwiseAbs2().dot(variance.col(c)), 1e-12);
    }
}

}  // namespace
}  // namespace polyrecon
