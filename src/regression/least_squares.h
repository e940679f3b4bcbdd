#pragma once

#include <array>
#include <vector>

#include "regression/basis.h"
#include "regression/window.h"

namespace polyrecon {

/// One weighted factorisation that serves every nested model: with S = diag(sqrt(w)) and X the design,
///     S X = Q R,   q_a = column a of S^-1 Q,   so that   sum_i w_i q_a(i) q_b(i) = (a == b).
/// The fit of any prefix of columns is yhat = sum_a z_a q_a with z_a = sum_i w_i q_a(i) y(i), and the projection matrix
/// of equations (5) and (6) is H_ij = sum_a q_a(i) q_a(j) w_j. H itself is never formed.
///
/// If columns depend on each other, the fit is that of a generalised ridge regression (Hoerl and Kennard 1970),
///     R^T R = X^T W X + diag(D),   D_a = limit_a^2 / rest_a,
/// where rest_a is the squared length of column a's remainder after the projection onto the columns before it, and
/// limit_a is the squared length at which a column counts for half (DependenceLimits). A column with rest_a much larger
/// than limit_a is hardly changed, and below limit_a it fades out, so that rounding never decides whether a column is
/// present. A faded q_a is shorter: sum_i w_i q_a(i)^2 <= 1 / (1 + (limit_a / rest_a)^2).
struct NestedFactor {
  int columns = 0;
  int rank = 0;  ///< Columns that count for more than half.
  int kept = 0;  ///< Columns that have not faded out entirely; only these are in q.
  std::array<int, BasisLayout::max_columns> kept_column{};  ///< Their indices in the design, rising; `kept` of them.
  std::vector<Real> q;  ///< window.padded rows of window.pitch values: the kept columns of a pixel, then zeros up to a
                        ///< multiple of vector_lanes.
  std::vector<double> scratch;  ///< Weighted responses.
};

/// Length of a column's remainder, after the projection onto the columns before it, at which the column counts for
/// half. docs/dev/stability.md derives the values.
struct DependenceLimits {
  double remainder = 0.03;             ///< Relative to the length of the whole column.
  double variation = least_variation;  ///< For features also at least this weighted root mean square over the window.
};

/// Factorises the window's design under the weights w (window.padded of them, >= 0, zero beyond window.count). The Gram
/// matrix is summed in double and factored by Cholesky in the order of the columns; q is the design times the inverse
/// of the resulting triangle.
void factorise(const Window& window, int columns, const Real* weight, NestedFactor& factor,
               const DependenceLimits& limits = {});

/// Computes z_a = sum_i w_i q_a(i) y(i) for every column a; zero for columns that are not kept. y has window.padded
/// samples.
void project(const NestedFactor& factor, const Window& window, const Real* weight, const Real* y, double* z);

/// Projects the three beauty channels of the window's response (z) and, if with_guess, of its guess (guess_z), and
/// computes the variance of z under the window's noise_variance,
///     s_a^2 = sum_i w_i^2 q_a(i)^2 noise_variance(i).
/// z, guess_z and s2 are 3 arrays of factor.columns values each. Uses factor.scratch.
void project_beauty(NestedFactor& factor, const Window& window, const Real* weight, bool with_guess, double* const* z,
                    double* const* guess_z, double* const* s2);

}  // namespace polyrecon
