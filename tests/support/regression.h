#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "regression/least_squares.h"
#include "regression/window.h"
#include "support/random.h"

namespace polyrecon::test {

/// A window with the given design, one row per pixel, rounded to Real. Rows of the padding are zero.
inline Window window_of(const Eigen::MatrixXd& design) {
  Window window;
  int radius = 0;
  while ((2 * radius + 1) * (2 * radius + 1) < design.rows()) ++radius;
  window.reserve(radius, static_cast<int>(design.cols()), 3);
  window.count = static_cast<int>(design.rows());
  window.padded = (window.count + Window::lanes - 1) / Window::lanes * Window::lanes;
  std::fill(window.design.begin(), window.design.end(), 0.0);
  for (int a = 0; a < design.cols(); ++a)
    for (int j = 0; j < design.rows(); ++j)
      window.design[static_cast<std::size_t>(j * window.pitch + a)] = static_cast<Real>(design(j, a));
  return window;
}

using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

/// Not inlined: GCC 12 at -O3 otherwise sees the conversions to Real and back, and its SLP vectoriser removes both for
/// some elements, which are then not rounded.
[[gnu::noinline]] inline RealMatrix rounded(const Eigen::MatrixXd& m) { return m.cast<Real>(); }

/// The values rounded to Real.
inline Eigen::MatrixXd stored(const Eigen::MatrixXd& m) { return rounded(m).cast<double>(); }

/// Weights or responses, rounded to Real and padded with zeros to the length of the window.
inline std::vector<Real> padded(const Eigen::VectorXd& v, const Window& window) {
  std::vector<Real> out(static_cast<std::size_t>(window.stride), Real(0));
  for (int j = 0; j < v.size(); ++j) out[static_cast<std::size_t>(j)] = static_cast<Real>(v(j));
  return out;
}

/// The first columns of values that are stored pixel by pixel with window.pitch.
template <typename T>
Eigen::MatrixXd rows_of(const std::vector<T>& values, int columns, const Window& window) {
  Eigen::MatrixXd m(window.count, columns);
  for (int a = 0; a < columns; ++a)
    for (int j = 0; j < window.count; ++j)
      m(j, a) = static_cast<double>(values[static_cast<std::size_t>(j * window.pitch + a)]);
  return m;
}

inline bool keeps(const NestedFactor& factor, int column) {
  const auto end = factor.kept_column.begin() + factor.kept;
  return std::find(factor.kept_column.begin(), end, column) != end;
}

/// S^-1 Q of a factorisation, pixels x columns; dropped columns are zero.
inline Eigen::MatrixXd q_of(const NestedFactor& factor, const Window& window) {
  const Eigen::MatrixXd kept = rows_of(factor.q, factor.kept, window);
  Eigen::MatrixXd q = Eigen::MatrixXd::Zero(window.count, factor.columns);
  for (int k = 0; k < factor.kept; ++k) q.col(factor.kept_column[static_cast<std::size_t>(k)]) = kept.col(k);
  return q;
}

inline Eigen::MatrixXd normal_matrix(int rows, int columns, Random& random) {
  Eigen::MatrixXd m(rows, columns);
  for (int a = 0; a < columns; ++a)
    for (int j = 0; j < rows; ++j) m(j, a) = random.normal();
  return m;
}

/// Weights in (0, 1], or zero with the probability zeros.
inline Eigen::VectorXd random_weights(int rows, double zeros, Random& random) {
  Eigen::VectorXd w(rows);
  for (int j = 0; j < rows; ++j) w(j) = random.uniform() < zeros ? 0 : random.uniform(0.01, 1);
  return w;
}

/// The projection matrix of equations (5) and (6), independently of factorise: H = X (S X)^+ S with the pseudoinverse
/// from Eigen's complete orthogonal decomposition.
inline Eigen::MatrixXd projection_matrix(const Eigen::MatrixXd& x, const Eigen::VectorXd& w) {
  const Eigen::VectorXd s = w.cwiseSqrt();
  const Eigen::MatrixXd sx = s.asDiagonal() * x;
  return x * sx.completeOrthogonalDecomposition().pseudoInverse() * s.asDiagonal();
}

inline constexpr double eps = std::numeric_limits<Real>::epsilon();

/// A design with its weights and factorisation. All numbers are rounded to Real, as the code under test sees them.
struct Problem {
  Eigen::MatrixXd x;
  Eigen::VectorXd w;
  Window window;
  std::vector<Real> weight;
  NestedFactor factor;

  Problem(const Eigen::MatrixXd& design, const Eigen::VectorXd& weights)
      : x(stored(design)), w(stored(weights)), window(window_of(design)), weight(padded(weights, window)) {
    factorise(window, static_cast<int>(x.cols()), weight.data(), factor);
  }

  Eigen::MatrixXd q() const { return q_of(factor, window); }
  Eigen::VectorXd coefficients(const Eigen::VectorXd& y) const {
    const auto response = padded(y, window);
    Eigen::VectorXd z(factor.columns);
    project(factor, window, weight.data(), response.data(), z.data());
    return z;
  }
};

inline Eigen::MatrixXd design_with_constant(int rows, int columns, Random& random) {
  Eigen::MatrixXd x = normal_matrix(rows, columns, random);
  x.col(0).setOnes();
  return x;
}

/// The generalised ridge regression of least_squares.h, solved by the Gram-Schmidt process: S X with the additional
/// rows diag(sqrt(D)) for the penalties is Q R, and Q has the rows S q and, below them, tail.
struct Penalised {
  Eigen::MatrixXd augmented;  ///< S X with the rows diag(sqrt(D)) below. Dropped columns are zero, as in q and tail.
  Eigen::MatrixXd q, tail;
};

/// Columns 1 to features are features, whose variation is limited too.
inline Penalised penalised(const Eigen::MatrixXd& x, const Eigen::VectorXd& w, const DependenceLimits& limits,
                           int features) {
  const Eigen::VectorXd s = w.cwiseSqrt();
  const auto rows = x.rows(), columns = x.cols();
  Eigen::MatrixXd a(rows + columns, columns), q = Eigen::MatrixXd::Zero(rows + columns, columns);
  a << s.asDiagonal() * x, Eigen::MatrixXd::Zero(columns, columns);
  Penalised out{a, x, {}};
  for (Eigen::Index k = 0; k < columns; ++k) {
    Eigen::VectorXd left = a.col(k);
    out.q.col(k) = x.col(k);
    for (int sweep = 0; sweep < 2; ++sweep)
      for (Eigen::Index b = 0; b < k; ++b) {
        const double part = q.col(b).dot(left);
        left -= part * q.col(b);
        out.q.col(k) -= part * out.q.col(b);  // also where S is zero
      }
    // The remainder includes the penalty rows of the columns before k: what those columns do not take, column k does.
    const double whole = a.col(k).squaredNorm(), rest = left.squaredNorm();
    const bool is_feature = k >= 1 && k <= features;
    const double little = std::max(limits.remainder * limits.remainder * whole,
                                   is_feature ? limits.variation * limits.variation * w.sum() : 0.0);
    const bool kept = rest > 3e-3 * little && rest > 0;
    const double penalty = kept ? little / std::sqrt(rest) : 0,
                 length = kept ? std::hypot(std::sqrt(rest), penalty) : 1;
    a(rows + k, k) = left(rows + k) = penalty;
    if (!kept) a.col(k) = left = Eigen::VectorXd::Zero(rows + columns);
    if (!kept) out.q.col(k).setZero();
    q.col(k) = left / length;
    out.q.col(k) /= length;
  }
  out.augmented = a;
  out.tail = q.bottomRows(columns);
  return out;
}

/// Largest difference between Q^T Q and the identity, for Q with the rows S q and tail. Dropped columns must be zero.
inline double orthonormality_error(const Problem& p) {
  const Eigen::MatrixXd q = p.q(), tail = penalised(p.x, p.w, {}, p.window.layout.features()).tail;
  const Eigen::MatrixXd gram = q.transpose() * p.w.asDiagonal() * q + tail.transpose() * tail;
  double worst = 0;
  for (int a = 0; a < gram.rows(); ++a)
    for (int b = 0; b < gram.cols(); ++b) {
      const double expected = a == b && keeps(p.factor, a) ? 1 : 0;
      worst = std::max(worst, std::abs(gram(a, b) - expected));
    }
  return worst;
}

}  // namespace polyrecon::test
