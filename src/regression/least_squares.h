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
/// Where columns depend on each other this is the fit of a generalised ridge regression (Hoerl and Kennard 1970),
///     R^T R = X^T W X + diag(D),   D_a = little_a^2 / rest_a,
/// with rest_a the square of what is left of column a beside those before it and little_a that of DependenceLimits: a
/// column of which enough is left counts whole, to (little / rest)^2, and fades out below, so that no rounding decides
/// whether it is there. q_a is shorter then: sum_i w_i q_a(i)^2 = 1 / (1 + (little_a / rest_a)^2) at most.
struct NestedFactor {
  int columns = 0;
  int rank = 0;  ///< Columns that count for more than half of themselves.
  int kept = 0;  ///< Columns of which there is something left to speak of; q has these alone,
  std::array<int, BasisLayout::max_columns> kept_column{};  ///< and these are they, rising.
  std::vector<Real> q;  ///< window.padded rows of window.pitch values, a pixel's kept columns side by side, then zeros
                        ///< to a multiple of vector_lanes.
  std::vector<double> scratch;  ///< Weighted responses.
};

/// Where a column, depending on those before it, counts for half: docs/dev/stability.md has what speaks for these
/// values.
struct DependenceLimits {
  double remainder = 0.03;             ///< This part of its length is left beside them, or,
  double variation = least_variation;  ///< if a feature's, this weighted root mean square over the window.
};

/// Factorises the window's design under the weights w (window.padded of them, >= 0, zero beyond window.count). The Gram
/// matrix is summed in double and factored by Cholesky in the order of the columns; q is the design times the inverse
/// of the triangle that this leaves.
void factorise(const Window& window, int columns, const Real* weight, NestedFactor& factor,
               const DependenceLimits& limits = {});

/// z_a = sum_i w_i q_a(i) y(i) for every column a; zero for dropped ones. y has window.padded samples.
void project(const NestedFactor& factor, const Window& window, const Real* weight, const Real* y, double* z);

/// What project gives for the three channels of the beauty and of the stage's guess, and the variance of the former,
///     s_a^2 = sum_i w_i^2 q_a(i)^2 variance(i)   where the noise at pixel i has that variance,
/// for the window's response, guess (where with_guess) and noise_variance. z, guess_z and s2: 3 arrays of
/// factor.columns sums. Uses factor.scratch.
void project_beauty(NestedFactor& factor, const Window& window, const Real* weight, bool with_guess, double* const* z,
                    double* const* guess_z, double* const* s2);

}  // namespace polyrecon
