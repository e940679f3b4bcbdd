#include "regression/least_squares.h"

#include <algorithm>
#include <cmath>

#include "core/simd.h"

// The columns of a pixel are adjacent in memory, and sums over pixels are kept in registers for four columns at a time,
// here called a tile. So no vector has to be summed across its lanes, which would be most of the work for the small
// windows of finer lattices, and each sum is loaded and stored once per window.
namespace polyrecon {
namespace {

constexpr int tile = vector_lanes;
constexpr int max_tiles = (BasisLayout::max_columns + tile - 1) / tile;
constexpr int max_columns = max_tiles * tile;
constexpr int rows_at_once = 2 * tile;  ///< Rows of the Gram matrix; so many sums hide the latency of an addition.
/// A column is dropped where its squared remainder is below this part of its limit: with its penalty it would count for
/// (3e-3)^2, about 1e-5.
constexpr double negligible = 3e-3;

/// Row-major, padded to whole tiles.
struct Matrix {
  double at[max_columns][max_columns];
};

int tiles_of(int columns) { return (columns + tile - 1) / tile; }

/// Computes sums[k][b] = sum_j w_j x_k(j) y_b(j) for rows_at_once columns x and a tile of columns y. Rows j are pitch
/// values apart.
POLYRECON_SIMD void tile_of_gram(const double* x, const double* y, std::size_t pitch, const Real* weight, int rows,
                                 double (*sums)[max_columns]) {
  Doubles s[rows_at_once] = {};
  for (int j = 0; j < rows; ++j, x += pitch, y += pitch) {
    const Doubles wy = static_cast<double>(weight[j]) * *reinterpret_cast<const StoredDoubles*>(y);
#pragma GCC unroll 8
    for (int k = 0; k < rows_at_once; ++k) s[k] += x[k] * wy;
  }
#pragma GCC unroll 8
  for (int k = 0; k < rows_at_once; ++k) *reinterpret_cast<StoredDoubles*>(sums[k]) = s[k];
}

/// Computes the Gram matrix X^T W X: the tiles on the diagonal and to the right of it.
void gram_matrix(const Window& window, const Real* weight, int tiles, Matrix& gram) {
  for (int a = 0; a < tiles * tile; a += rows_at_once)
    for (int b = a; b < tiles * tile; b += tile)
      tile_of_gram(window.design.data() + a, window.design.data() + b, static_cast<std::size_t>(window.pitch), weight,
                   window.padded, reinterpret_cast<double(*)[max_columns]>(&gram.at[a][b]));
}

/// The row of R of a kept column, followed by its row of the inverse of R^T: the factor that this column of Q takes of
/// each column of the design.
template <int tiles>
struct FactorRow {
  double at[2 * tiles * tile];
};

/// One step of the Cholesky factorisation: subtracts the first `above` rows, each times its value in column a, from
/// the row after them.
template <int tiles>
POLYRECON_SIMD void subtract_above(FactorRow<tiles>* rows, int above, int a) {
  Doubles s[2 * tiles];
#pragma GCC unroll 16
  for (int t = 0; t < 2 * tiles; ++t) s[t] = *reinterpret_cast<const StoredDoubles*>(rows[above].at + t * tile);
  for (int c = 0; c < above; ++c) {
    const double factor = rows[c].at[a];
#pragma GCC unroll 16
    for (int t = 0; t < 2 * tiles; ++t) s[t] -= factor * *reinterpret_cast<const StoredDoubles*>(rows[c].at + t * tile);
  }
#pragma GCC unroll 16
  for (int t = 0; t < 2 * tiles; ++t) *reinterpret_cast<StoredDoubles*>(rows[above].at + t * tile) = s[t];
}

/// The remainder of a column after the projection onto the columns before it.
struct Remainder {
  double inverse_length = 0;  ///< 1 / (length with the penalty); 0 where the column is dropped.
  bool independent = false;   ///< Its squared length is above the limit, so the column counts for more than half.
};

/// rest and whole: squared lengths of a column's remainder and of the column itself. weight_sum: sum of the window's
/// weights.
Remainder remainder_of(double rest, double whole, double weight_sum, bool is_feature, const DependenceLimits& limits) {
  const double limit = std::max(limits.remainder * limits.remainder * whole,
                                is_feature ? limits.variation * limits.variation * weight_sum : 0.0);
  const double square = rest + limit * (limit / rest);
  // The length and its inverse must be values of the storage type, or q overflows.
  const bool keep =
      rest > negligible * limit && std::isnormal(rest) && std::isnormal(static_cast<Real>(std::sqrt(square)));
  return {keep ? 1 / std::sqrt(square) : 0, keep && rest > limit};
}

/// Factors the Gram matrix into R^T R, row by row from the top, and sets the kept columns and the rank. inverse becomes
/// R^-1: row b holds the factors that the kept columns of Q take of column b of the design.
template <int tiles>
void invert_factor(const Matrix& gram, const BasisLayout& layout, const DependenceLimits& limits, NestedFactor& factor,
                   Matrix& inverse) {
  constexpr int width = tiles * tile;
  FactorRow<tiles> rows[width];
  for (int a = 0; a < factor.columns; ++a) {
    double* const row = rows[factor.kept].at;  // overwritten by the next column if this one is dropped
    const int first = a / tile * tile;         // gram_matrix leaves the columns before this one unset
    std::fill_n(row, 2 * width, 0.0);
    std::copy(gram.at[a] + first, gram.at[a] + width, row + first);
    row[width + a] = 1;
    subtract_above(rows, factor.kept, a);
    const bool is_feature = a >= 1 && a <= layout.features();
    const Remainder left = remainder_of(row[a], gram.at[a][a], gram.at[0][0], is_feature, limits);
    factor.rank += left.independent;
    if (left.inverse_length == 0) continue;
    for (int b = 0; b < 2 * width; ++b) row[b] *= left.inverse_length;
    factor.kept_column[static_cast<std::size_t>(factor.kept++)] = a;
  }
  for (int b = 0; b < factor.columns; ++b)
    for (int k = 0; k < width; ++k) inverse.at[b][k] = k < factor.kept ? rows[k].at[width + b] : 0;
}

/// Computes a tile of columns of q = X R^-1 for all pixels. They depend on the first `columns` columns of X only, as R
/// is triangular.
POLYRECON_SIMD void tile_of_q(const double* x, std::size_t pitch, const double (*inverse)[max_columns], int columns,
                              int rows, Real* q) {
  constexpr int at_once = 4;  // pixels: a row of the inverse is loaded once for all of them
  for (int j = 0; j < rows; j += at_once, x += at_once * pitch, q += at_once * pitch) {
    const double *x0 = x, *x1 = x + pitch, *x2 = x1 + pitch, *x3 = x2 + pitch;
    Doubles s0 = {}, s1 = {}, s2 = {}, s3 = {};
    for (int b = 0; b < columns; ++b) {
      const Doubles r = *reinterpret_cast<const StoredDoubles*>(inverse[b]);
      s0 += x0[b] * r;
      s1 += x1[b] * r;
      s2 += x2[b] * r;
      s3 += x3[b] * r;
    }
    *reinterpret_cast<StoredReals*>(q) = __builtin_convertvector(s0, StoredReals);
    *reinterpret_cast<StoredReals*>(q + pitch) = __builtin_convertvector(s1, StoredReals);
    *reinterpret_cast<StoredReals*>(q + 2 * pitch) = __builtin_convertvector(s2, StoredReals);
    *reinterpret_cast<StoredReals*>(q + 3 * pitch) = __builtin_convertvector(s3, StoredReals);
  }
}

/// Number of leading columns of the design that a tile of q, beginning with column k of q, depends on.
int columns_needed(const NestedFactor& factor, int k) {
  return factor.kept_column[static_cast<std::size_t>(std::min(k + tile, factor.kept) - 1)] + 1;
}

template <int tiles>
void factorise_tiles(const Window& window, const Real* weight, NestedFactor& factor, const DependenceLimits& limits) {
  Matrix gram, inverse;
  gram_matrix(window, weight, tiles, gram);
  invert_factor<tiles>(gram, window.layout, limits, factor, inverse);
  for (int k = 0; k < factor.kept; k += tile)
    tile_of_q(window.design.data(), static_cast<std::size_t>(window.pitch),
              reinterpret_cast<const double(*)[max_columns]>(&inverse.at[0][k]), columns_needed(factor, k),
              window.padded, factor.q.data() + k);
}

POLYRECON_SIMD void multiply(const Real* a, const Real* b, double* product, int rows) {
  for (int j = 0; j < rows; ++j) product[j] = static_cast<double>(a[j]) * static_cast<double>(b[j]);
}

POLYRECON_SIMD void multiply_by(const Real* factor, double* y, int rows) {
  for (int j = 0; j < rows; ++j) y[j] *= static_cast<double>(factor[j]);
}

/// Computes sums[a] = sum_j w_j q_a(j) y(j) for a tile of columns.
POLYRECON_SIMD void tile_sums(const Real* q, std::size_t pitch, const Real* weight, const Real* y, int rows,
                              double* sums) {
  Doubles s = {};
  for (int j = 0; j < rows; ++j, q += pitch)
    s += static_cast<double>(weight[j]) * static_cast<double>(y[j]) *
         __builtin_convertvector(*reinterpret_cast<const StoredReals*>(q), Doubles);
  *reinterpret_cast<StoredDoubles*>(sums) = s;
}

/// The same for responses that are weighted already: y holds three responses, three guesses (used if with_guess) and
/// three variances, stride values apart. Variances are summed with the squares of q. The tile's sums go to
/// sums[0..8][k ...].
template <bool with_guess>
POLYRECON_SIMD void tile_sums_of_beauty(const Real* q, std::size_t pitch, const double* y, std::size_t stride, int rows,
                                        double (*sums)[max_columns], int k) {
  Doubles z0 = {}, z1 = {}, z2 = {}, g0 = {}, g1 = {}, g2 = {}, v0 = {}, v1 = {}, v2 = {};
  const double *y0 = y, *y1 = y + stride, *y2 = y1 + stride, *m0 = y2 + stride, *m1 = m0 + stride, *m2 = m1 + stride;
  const double *n0 = m2 + stride, *n1 = n0 + stride, *n2 = n1 + stride;
  for (int j = 0; j < rows; ++j, q += pitch) {
    const Doubles p = __builtin_convertvector(*reinterpret_cast<const StoredReals*>(q), Doubles);
    const Doubles square = p * p;
    z0 += y0[j] * p;
    z1 += y1[j] * p;
    z2 += y2[j] * p;
    if (with_guess) {
      g0 += m0[j] * p;
      g1 += m1[j] * p;
      g2 += m2[j] * p;
    }
    v0 += n0[j] * square;
    v1 += n1[j] * square;
    v2 += n2[j] * square;
  }
  const Doubles all[9] = {z0, z1, z2, g0, g1, g2, v0, v1, v2};
  for (int c = 0; c < 9; ++c) *reinterpret_cast<StoredDoubles*>(sums[c] + k) = all[c];
}

/// Copies the sums of the kept columns to the columns of the design; zero for columns that are not kept.
void scatter(const double* kept_sums, const NestedFactor& factor, double* sums) {
  std::fill_n(sums, factor.columns, 0.0);
  for (std::size_t k = 0; k < static_cast<std::size_t>(factor.kept); ++k) sums[factor.kept_column[k]] = kept_sums[k];
}

}  // namespace

void factorise(const Window& window, int columns, const Real* weight, NestedFactor& factor,
               const DependenceLimits& limits) {
  factor.columns = columns;
  factor.rank = factor.kept = 0;
  factor.q.resize(static_cast<std::size_t>(window.stride) * static_cast<std::size_t>(window.pitch));
  factor.scratch.resize(9 * static_cast<std::size_t>(window.stride));
  static_assert(max_tiles == 8);
  switch (tiles_of(columns)) {
    case 1:
      return factorise_tiles<1>(window, weight, factor, limits);
    case 2:
      return factorise_tiles<2>(window, weight, factor, limits);
    case 3:
      return factorise_tiles<3>(window, weight, factor, limits);
    case 4:
      return factorise_tiles<4>(window, weight, factor, limits);
    case 5:
      return factorise_tiles<5>(window, weight, factor, limits);
    case 6:
      return factorise_tiles<6>(window, weight, factor, limits);
    case 7:
      return factorise_tiles<7>(window, weight, factor, limits);
    default:
      return factorise_tiles<8>(window, weight, factor, limits);
  }
}

void project(const NestedFactor& factor, const Window& window, const Real* weight, const Real* y, double* z) {
  double sums[max_columns];
  for (int k = 0; k < factor.kept; k += tile)
    tile_sums(factor.q.data() + k, static_cast<std::size_t>(window.pitch), weight, y, window.padded, sums + k);
  scatter(sums, factor, z);
}

void project_beauty(NestedFactor& factor, const Window& window, const Real* weight, bool with_guess, double* const* z,
                    double* const* guess_z, double* const* s2) {
  const auto stride = static_cast<std::size_t>(window.stride);
  double* const scaled = factor.scratch.data();
  const auto weigh = [&](const std::vector<Real>& channels, std::size_t first) {
    for (std::size_t c = 0; c < 3; ++c)
      multiply(weight, channels.data() + c * stride, scaled + (first + c) * stride, window.padded);
  };
  weigh(window.response, 0);
  if (with_guess) weigh(window.guess, 3);
  weigh(window.noise_variance, 6);
  for (std::size_t c = 6; c < 9; ++c) multiply_by(weight, scaled + c * stride, window.padded);
  double sums[9][max_columns];
  const auto sum = with_guess ? tile_sums_of_beauty<true> : tile_sums_of_beauty<false>;
  for (int k = 0; k < factor.kept; k += tile)
    sum(factor.q.data() + k, static_cast<std::size_t>(window.pitch), scaled, stride, window.padded, sums, k);
  for (std::size_t c = 0; c < 3; ++c) {
    scatter(sums[c], factor, z[c]);
    if (with_guess) scatter(sums[3 + c], factor, guess_z[c]);
    scatter(sums[6 + c], factor, s2[c]);
  }
}

}  // namespace polyrecon
