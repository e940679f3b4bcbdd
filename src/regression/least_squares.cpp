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

/// gram[a][b] = sum_j w_j x_a(j) x_b(j) for b <= a. Two by two columns, so that each load serves two products.
POLYRECON_SIMD void gram_matrix(const Real* x, const Real* weighted, int columns, int rows, std::size_t stride,
                                double (*gram)[max_columns]) {
  for (int a = 0; a < columns; a += 2) {
    const Real* wa0 = weighted + static_cast<std::size_t>(a) * stride;
    const Real* wa1 = a + 1 < columns ? wa0 + stride : wa0;
    for (int b = 0; b <= a; b += 2) {
      const Real* xb0 = x + static_cast<std::size_t>(b) * stride;
      const Real* xb1 = b + 1 < columns ? xb0 + stride : xb0;
      double s00 = 0, s01 = 0, s10 = 0, s11 = 0;
#pragma omp simd reduction(+ : s00, s01, s10, s11)
      for (int j = 0; j < rows; ++j) {
        const double p = wa0[j], q = wa1[j], u = xb0[j], v = xb1[j];
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

POLYRECON_SIMD void scale(Real* y, Real factor, int rows) {
  for (int j = 0; j < rows; ++j) y[j] *= factor;
}

/// Cholesky of the Gram matrix, row by row. Returns in inverse[a] 1/l_aa, or 0 where column a is dropped; in ratio[a]
/// the squared length that is left of column a, relative to its own.
void nested_cholesky(const Matrix& gram, int columns, Matrix& l, double* inverse, double* ratio) {
  for (int a = 0; a < columns; ++a) {
    double rest = gram[a][a];
    for (int b = 0; b < a; ++b) {
      double sum = gram[a][b];
      for (int c = 0; c < b; ++c) sum -= l[a][c] * l[b][c];
      l[a][b] = sum * inverse[b];
      rest -= l[a][b] * l[a][b];
    }
    ratio[a] = gram[a][a] > 0 ? rest / gram[a][a] : 0;
    const bool keep = ratio[a] > drop_below && std::isnormal(rest);
    inverse[a] = keep ? 1 / std::sqrt(rest) : 0;
  }
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
  for (int a = 0; a < columns; ++a) {
    const std::size_t offset = static_cast<std::size_t>(a) * stride;
    multiply(weight, window.design.data() + offset, factor.q.data() + offset, window.padded);
  }
  Matrix gram, l;
  double inverse[max_columns], ratio[max_columns];
  gram_matrix(window.design.data(), factor.q.data(), columns, window.padded, stride, gram);
  nested_cholesky(gram, columns, l, inverse, ratio);
  for (int a = 0; a < columns; ++a) {
    Real* qa = factor.q.data() + static_cast<std::size_t>(a) * stride;
    bool keep = inverse[a] != 0;
    if (keep) {
      const Real* xa = window.design.data() + static_cast<std::size_t>(a) * stride;
      std::copy(xa, xa + window.padded, qa);
      for (int b = 0; b < a; ++b)
        if (l[a][b] != 0)
          subtract_scaled(qa, factor.q.data() + static_cast<std::size_t>(b) * stride, static_cast<Real>(l[a][b]),
                          window.padded);
      scale(qa, static_cast<Real>(inverse[a]), window.padded);
      if (ratio[a] < repeat_below) keep = orthogonalise_again(factor, window, weight, a);
    }
    if (!keep) std::fill(qa, qa + window.padded, Real(0));
    factor.kept[static_cast<std::size_t>(a)] = keep;
    factor.rank += keep;
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
