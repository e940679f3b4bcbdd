#include "regression/least_squares.h"

#include <algorithm>
#include <cmath>

#include "core/simd.h"

namespace polyrecon {
namespace {

constexpr int max_columns = BasisLayout::max_columns;
using Matrix = double[max_columns][max_columns];

// Relative lengths (squared) of what is left of a column: below the first it is dropped, below the second cancellation
// has cost it too many digits to stay orthogonal ("twice is enough", Giraud and Langou 2002).
constexpr double drop_below = 1e-8, repeat_below = 1e-4;

/// gram[a][b] = sum_j x_a(j) x_b(j) for b <= a. Two by two columns, so that each load serves two products.
POLYRECON_SIMD void gram_matrix(const Real* x, int columns, int rows, std::size_t stride, double (*gram)[max_columns]) {
  for (int a = 0; a < columns; a += 2) {
    const Real* xa0 = x + static_cast<std::size_t>(a) * stride;
    const Real* xa1 = a + 1 < columns ? xa0 + stride : xa0;
    for (int b = 0; b <= a; b += 2) {
      const Real* xb0 = x + static_cast<std::size_t>(b) * stride;
      const Real* xb1 = b + 1 < columns ? xb0 + stride : xb0;
      double s00 = 0, s01 = 0, s10 = 0, s11 = 0;
#pragma omp simd reduction(+ : s00, s01, s10, s11)
      for (int j = 0; j < rows; ++j) {
        const double p = xa0[j], q = xa1[j], u = xb0[j], v = xb1[j];
        s00 += p * u;
        s01 += p * v;
        s10 += q * u;
        s11 += q * v;
      }
      gram[a][b] = s00;
      if (b + 1 < columns) gram[a][b + 1] = s01;
      if (a + 1 < columns) {
        gram[a + 1][b] = s10;
        if (b + 1 < columns) gram[a + 1][b + 1] = s11;
      }
    }
  }
}

POLYRECON_SIMD double weighted_dot(const Real* w, const Real* a, const Real* b, int rows) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int j = 0; j < rows; ++j)
    sum += static_cast<double>(w[j]) * static_cast<double>(a[j]) * static_cast<double>(b[j]);
  return sum;
}

POLYRECON_SIMD void subtract_scaled(Real* y, const Real* x, Real factor, int rows) {
  for (int j = 0; j < rows; ++j) y[j] -= factor * x[j];
}

POLYRECON_SIMD void multiply(const Real* a, const Real* b, Real* product, int rows) {
  for (int j = 0; j < rows; ++j) product[j] = a[j] * b[j];
}

POLYRECON_SIMD void square_roots(const Real* in, Real* out, int rows) {
  for (int j = 0; j < rows; ++j) out[j] = std::sqrt(in[j]);
}

POLYRECON_SIMD void scale(Real* y, Real factor, int rows) {
  for (int j = 0; j < rows; ++j) y[j] *= factor;
}

/// What is left of column a beside those before it.
struct Remainder {
  double ratio;    ///< Its squared length, relative to the column's own.
  double inverse;  ///< 1 / length.
  bool keep;
};

Remainder remainder_of(const Matrix& gram, const Matrix& l, int a) {
  double rest = gram[a][a];
  for (int b = 0; b < a; ++b) rest -= l[a][b] * l[a][b];
  const double ratio = gram[a][a] > 0 ? rest / gram[a][a] : 0;
  // The length and its inverse must be values of the storage type, or q overflows.
  const bool keep = ratio > drop_below && std::isnormal(rest) && std::isnormal(static_cast<Real>(std::sqrt(rest)));
  return {ratio, keep ? 1 / std::sqrt(rest) : 0, keep};
}

/// The inner product of column b > a with the part of column a that is orthogonal to those before it.
double cholesky_entry(const Matrix& gram, const Matrix& l, int a, int b) {
  double sum = gram[b][a];
  for (int c = 0; c < a; ++c) sum -= l[b][c] * l[a][c];
  return sum;
}

void normalised_remainder(const Window& window, const Matrix& l, int a, double inverse, NestedFactor& factor) {
  const auto stride = static_cast<std::size_t>(window.stride);
  const Real* xa = window.design.data() + static_cast<std::size_t>(a) * stride;
  Real* qa = factor.q.data() + static_cast<std::size_t>(a) * stride;
  std::copy(xa, xa + window.padded, qa);
  for (int b = 0; b < a; ++b)
    if (l[a][b] != 0)
      subtract_scaled(qa, factor.q.data() + static_cast<std::size_t>(b) * stride, static_cast<Real>(l[a][b]),
                      window.padded);
  scale(qa, static_cast<Real>(inverse), window.padded);
}

/// A second sweep for a column that lost digits to cancellation; false if nothing is left of it.
bool orthogonalise_again(NestedFactor& factor, const Window& window, const Real* weight, int a) {
  Real* qa = factor.q.data() + static_cast<std::size_t>(a) * static_cast<std::size_t>(window.stride);
  for (int b = 0; b < a; ++b) {
    if (!factor.kept[static_cast<std::size_t>(b)]) continue;
    const Real* qb = factor.q.data() + static_cast<std::size_t>(b) * static_cast<std::size_t>(window.stride);
    subtract_scaled(qa, qb, static_cast<Real>(weighted_dot(weight, qa, qb, window.padded)), window.padded);
  }
  const double length = weighted_dot(weight, qa, qa, window.padded);
  if (!(length > 0.25)) return false;  // it was 1 before the sweep: what went was rounding, not signal
  scale(qa, static_cast<Real>(1 / std::sqrt(length)), window.padded);
  return true;
}

/// Nine sums over one column in one pass: w q y, w q g and (w q)^2 v for three channels each.
POLYRECON_SIMD void beauty_sums(const Real* w, const Real* q, const Real* y, const Real* g, const Real* v,
                                std::size_t stride, int rows, double* sums) {
  const Real *y1 = y + stride, *y2 = y1 + stride, *g1 = g + stride, *g2 = g1 + stride, *v1 = v + stride,
             *v2 = v1 + stride;
  double a0 = 0, a1 = 0, a2 = 0, b0 = 0, b1 = 0, b2 = 0, c0 = 0, c1 = 0, c2 = 0;
#pragma omp simd reduction(+ : a0, a1, a2, b0, b1, b2, c0, c1, c2)
  for (int j = 0; j < rows; ++j) {
    const double wq = static_cast<double>(w[j]) * static_cast<double>(q[j]), square = wq * wq;
    a0 += wq * static_cast<double>(y[j]);
    a1 += wq * static_cast<double>(y1[j]);
    a2 += wq * static_cast<double>(y2[j]);
    b0 += wq * static_cast<double>(g[j]);
    b1 += wq * static_cast<double>(g1[j]);
    b2 += wq * static_cast<double>(g2[j]);
    c0 += square * static_cast<double>(v[j]);
    c1 += square * static_cast<double>(v1[j]);
    c2 += square * static_cast<double>(v2[j]);
  }
  const double all[9] = {a0, a1, a2, b0, b1, b2, c0, c1, c2};
  std::copy(all, all + 9, sums);
}

}  // namespace

void factorise(const Window& window, int columns, const Real* weight, NestedFactor& factor) {
  const auto stride = static_cast<std::size_t>(window.stride);
  factor.columns = columns;
  factor.rank = 0;
  factor.q.resize(stride * static_cast<std::size_t>(columns));
  factor.root.resize(stride);
  square_roots(weight, factor.root.data(), window.padded);
  // The Gram matrix of S X as it is rounded: that of (W X) and X, rounded apart, need not be positive definite.
  for (int a = 0; a < columns; ++a) {
    const std::size_t offset = static_cast<std::size_t>(a) * stride;
    multiply(factor.root.data(), window.design.data() + offset, factor.q.data() + offset, window.padded);
  }
  Matrix gram, l;
  gram_matrix(factor.q.data(), columns, window.padded, stride, gram);
  for (int a = 0; a < columns; ++a) {
    const Remainder remainder = remainder_of(gram, l, a);
    Real* const qa = factor.q.data() + static_cast<std::size_t>(a) * stride;
    const bool again = remainder.ratio < repeat_below;
    if (remainder.keep) normalised_remainder(window, l, a, remainder.inverse, factor);
    const bool keep = remainder.keep && (!again || orthogonalise_again(factor, window, weight, a));
    if (!keep) std::fill(qa, qa + window.padded, Real(0));
    factor.kept[static_cast<std::size_t>(a)] = keep;
    factor.rank += keep;
    for (int b = a + 1; b < columns; ++b) {
      const Real* const xb = window.design.data() + static_cast<std::size_t>(b) * stride;
      // A column that lost digits points elsewhere than the Gram matrix says: ask the column itself.
      l[b][a] = !keep   ? 0
                : again ? weighted_dot(weight, qa, xb, window.padded)
                        : cholesky_entry(gram, l, a, b) * remainder.inverse;
    }
  }
}

void project(const NestedFactor& factor, const Window& window, const Real* weight, const Real* y, double* z) {
  for (int a = 0; a < factor.columns; ++a) {
    const Real* qa = factor.q.data() + static_cast<std::size_t>(a) * static_cast<std::size_t>(window.stride);
    z[a] = factor.kept[static_cast<std::size_t>(a)] ? weighted_dot(weight, qa, y, window.padded) : 0;
  }
}

void project_beauty(const NestedFactor& factor, const Window& window, const Real* weight, double* const* z,
                    double* const* guess_z, double* const* s2) {
  const auto stride = static_cast<std::size_t>(window.stride);
  for (int a = 0; a < factor.columns; ++a) {
    double sums[9] = {};
    if (factor.kept[static_cast<std::size_t>(a)])
      beauty_sums(weight, factor.q.data() + static_cast<std::size_t>(a) * stride, window.response.data(),
                  window.guess.data(), window.noise_variance.data(), stride, window.padded, sums);
    for (int c = 0; c < 3; ++c) {
      z[c][a] = sums[c];
      guess_z[c][a] = sums[3 + c];
      s2[c][a] = sums[6 + c];
    }
  }
}

}  // namespace polyrecon
