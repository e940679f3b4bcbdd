#include "regression/least_squares.h"

#include <algorithm>
#include <cmath>

#include "core/simd.h"

namespace polyrecon {
namespace {

constexpr int max_columns = BasisLayout::max_columns;
/// Part of the limit (of squares) below which a column goes: with its penalty it would count for 1e-5 of itself.
constexpr double as_good_as_nothing = 3e-3;
using Matrix = double[max_columns][max_columns];

POLYRECON_SIMD void multiply(const Real* a, const Real* b, double* product, int rows) {
  for (int j = 0; j < rows; ++j) product[j] = static_cast<double>(a[j]) * static_cast<double>(b[j]);
}

POLYRECON_SIMD void multiply_by(const Real* factor, double* y, int rows) {
  for (int j = 0; j < rows; ++j) y[j] *= static_cast<double>(factor[j]);
}

/// Inner products of four columns with two: each load serves two or four products, the sums fit the registers.
POLYRECON_SIMD void products_4x2(const double* const* x, const double* const* y, int rows, double* sums) {
  const double *x0 = x[0], *x1 = x[1], *x2 = x[2], *x3 = x[3], *y0 = y[0], *y1 = y[1];
  double s00 = 0, s01 = 0, s10 = 0, s11 = 0, s20 = 0, s21 = 0, s30 = 0, s31 = 0;
#pragma omp simd reduction(+ : s00, s01, s10, s11, s20, s21, s30, s31)
  for (int j = 0; j < rows; ++j) {
    s00 += x0[j] * y0[j];
    s01 += x0[j] * y1[j];
    s10 += x1[j] * y0[j];
    s11 += x1[j] * y1[j];
    s20 += x2[j] * y0[j];
    s21 += x2[j] * y1[j];
    s30 += x3[j] * y0[j];
    s31 += x3[j] * y1[j];
  }
  const double all[8] = {s00, s01, s10, s11, s20, s21, s30, s31};
  std::copy(all, all + 8, sums);
}

/// gram[a][b] = sum_j x_a(j) x_b(j) for b <= a.
void gram_matrix(const double* columns, int count, int rows, std::size_t stride, double (*gram)[max_columns]) {
  const auto column = [&](int a) { return columns + static_cast<std::size_t>(std::min(a, count - 1)) * stride; };
  for (int a = 0; a < count; a += 4) {
    const double* x[4] = {column(a), column(a + 1), column(a + 2), column(a + 3)};
    for (int b = 0; b < std::min(a + 4, count); b += 2) {
      const double* y[2] = {column(b), column(b + 1)};
      double sums[8];
      products_4x2(x, y, rows, sums);
      for (int k = 0; k < 8; ++k)
        if (a + k / 2 < count && b + k % 2 < count) gram[a + k / 2][b + k % 2] = sums[k];
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

POLYRECON_SIMD void square_roots(const Real* in, Real* out, int rows) {
  for (int j = 0; j < rows; ++j) out[j] = std::sqrt(in[j]);
}

/// y -= sum of four columns, each times its factor: y is loaded and stored once.
POLYRECON_SIMD void subtract_four(Real* y, const Real* const* x, const Real* factor, int rows) {
  const Real *x0 = x[0], *x1 = x[1], *x2 = x[2], *x3 = x[3];
  const Real f0 = factor[0], f1 = factor[1], f2 = factor[2], f3 = factor[3];
  for (int j = 0; j < rows; ++j) y[j] -= f0 * x0[j] + f1 * x1[j] + f2 * x2[j] + f3 * x3[j];
}

POLYRECON_SIMD void scale(Real* y, Real factor, int rows) {
  for (int j = 0; j < rows; ++j) y[j] *= factor;
}

/// What is left of a column beside those before it.
struct Remainder {
  double inverse_length = 0;  ///< 1 / (length with the penalty); 0 where the column is as good as dependent.
  bool independent = false;   ///< More is left than the limits ask for.
};

Remainder remainder_of(const Matrix& gram, const Matrix& l, int a, const BasisLayout& layout,
                       const DependenceLimits& limits) {
  double rest = gram[a][a];
  for (int b = 0; b < a; ++b) rest -= l[a][b] * l[a][b];
  const bool is_feature = a >= 1 && a <= layout.features();
  const double weight_sum = gram[0][0];  // column 0 is 1 everywhere
  const double little = std::max(limits.remainder * limits.remainder * gram[a][a],
                                 is_feature ? limits.variation * limits.variation * weight_sum : 0.0);
  const double square = rest + little * (little / rest);
  // The length and its inverse must be values of the storage type, or q overflows.
  const bool keep =
      rest > as_good_as_nothing * little && std::isnormal(rest) && std::isnormal(static_cast<Real>(std::sqrt(square)));
  return {keep ? 1 / std::sqrt(square) : 0, keep && rest > little};
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
  const auto q = [&](int b) { return factor.q.data() + static_cast<std::size_t>(b) * stride; };
  int b = 0;
  for (; b + 4 <= a; b += 4) {
    const Real* const four[4] = {q(b), q(b + 1), q(b + 2), q(b + 3)};
    const Real factors[4] = {static_cast<Real>(l[a][b]), static_cast<Real>(l[a][b + 1]), static_cast<Real>(l[a][b + 2]),
                             static_cast<Real>(l[a][b + 3])};
    subtract_four(qa, four, factors, window.padded);
  }
  for (; b < a; ++b) subtract_scaled(qa, q(b), static_cast<Real>(l[a][b]), window.padded);
  scale(qa, static_cast<Real>(inverse), window.padded);
}

/// sums[c][k] = sum_j q_k(j) y_c(j) for two columns q and three y, or of the squares of q.
template <bool squared>
POLYRECON_SIMD void sums_2x3(const Real* q0, const Real* q1, const double* y, std::size_t stride, int rows,
                             double* sums) {
  const double *y0 = y, *y1 = y + stride, *y2 = y1 + stride;
  double s00 = 0, s01 = 0, s10 = 0, s11 = 0, s20 = 0, s21 = 0;
#pragma omp simd reduction(+ : s00, s01, s10, s11, s20, s21)
  for (int j = 0; j < rows; ++j) {
    const double p0 = q0[j], p1 = q1[j], u = squared ? p0 * p0 : p0, v = squared ? p1 * p1 : p1;
    s00 += u * y0[j];
    s01 += v * y0[j];
    s10 += u * y1[j];
    s11 += v * y1[j];
    s20 += u * y2[j];
    s21 += v * y2[j];
  }
  const double all[6] = {s00, s01, s10, s11, s20, s21};
  std::copy(all, all + 6, sums);
}

/// out[c][a] = sum_j q_a(j)^power y_c(j) for all columns.
template <bool squared>
void column_sums(const NestedFactor& factor, const double* y, std::size_t stride, int rows, double* const* out) {
  for (int a = 0; a < factor.columns; a += 2) {
    const Real* const q = factor.q.data() + static_cast<std::size_t>(a) * stride;
    const bool two = a + 1 < factor.columns;
    double sums[6];
    sums_2x3<squared>(q, two ? q + stride : q, y, stride, rows, sums);
    for (std::size_t c = 0; c < 3; ++c) {
      out[c][a] = sums[2 * c];
      if (two) out[c][a + 1] = sums[2 * c + 1];
    }
  }
}

}  // namespace

void factorise(const Window& window, int columns, const Real* weight, NestedFactor& factor,
               const DependenceLimits& limits) {
  const auto stride = static_cast<std::size_t>(window.stride);
  factor.columns = columns;
  factor.rank = 0;
  factor.q.resize(stride * static_cast<std::size_t>(columns));
  factor.root.resize(stride);
  factor.scratch.resize(stride * static_cast<std::size_t>(std::max(columns, 3)));
  square_roots(weight, factor.root.data(), window.padded);
  // The Gram matrix of S X: that of (W X) and X, rounded apart, need not be positive definite.
  for (int a = 0; a < columns; ++a) {
    const std::size_t offset = static_cast<std::size_t>(a) * stride;
    multiply(factor.root.data(), window.design.data() + offset, factor.scratch.data() + offset, window.padded);
  }
  Matrix gram, l;
  gram_matrix(factor.scratch.data(), columns, window.padded, stride, gram);
  for (int a = 0; a < columns; ++a) {
    const Remainder left = remainder_of(gram, l, a, window.layout, limits);
    const bool keep = left.inverse_length > 0;
    Real* const qa = factor.q.data() + static_cast<std::size_t>(a) * stride;
    if (keep)
      normalised_remainder(window, l, a, left.inverse_length, factor);
    else
      std::fill(qa, qa + window.padded, Real(0));
    factor.kept[static_cast<std::size_t>(a)] = keep;
    factor.rank += left.independent;
    for (int b = a + 1; b < columns; ++b) l[b][a] = keep ? cholesky_entry(gram, l, a, b) * left.inverse_length : 0;
  }
}

void project(const NestedFactor& factor, const Window& window, const Real* weight, const Real* y, double* z) {
  for (int a = 0; a < factor.columns; ++a) {
    const Real* qa = factor.q.data() + static_cast<std::size_t>(a) * static_cast<std::size_t>(window.stride);
    z[a] = factor.kept[static_cast<std::size_t>(a)] ? weighted_dot(weight, qa, y, window.padded) : 0;
  }
}

void project_beauty(NestedFactor& factor, const Window& window, const Real* weight, bool with_guess, double* const* z,
                    double* const* guess_z, double* const* s2) {
  const auto stride = static_cast<std::size_t>(window.stride);
  double* const scaled = factor.scratch.data();
  const auto weigh = [&](const std::vector<Real>& channels) {
    for (std::size_t c = 0; c < 3; ++c)
      multiply(weight, channels.data() + c * stride, scaled + c * stride, window.padded);
  };
  weigh(window.response);
  column_sums<false>(factor, scaled, stride, window.padded, z);
  if (with_guess) {
    weigh(window.guess);
    column_sums<false>(factor, scaled, stride, window.padded, guess_z);
  }
  weigh(window.noise_variance);
  for (std::size_t c = 0; c < 3; ++c) multiply_by(weight, scaled + c * stride, window.padded);
  column_sums<true>(factor, scaled, stride, window.padded, s2);
}

}  // namespace polyrecon
