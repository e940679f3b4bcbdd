#include "regression/least_squares.h"

#include <algorithm>
#include <cmath>

#include "core/simd.h"

// A pixel's columns stand side by side, and the sums over pixels are kept four columns at a time in registers: a tile.
// So no sum ends within a vector, which for the small windows of finer lattices was most of the work, and a sum is
// loaded and stored once a window.
namespace polyrecon {
namespace {

constexpr int tile = vector_lanes;
constexpr int max_tiles = (BasisLayout::max_columns + tile - 1) / tile;
constexpr int max_columns = max_tiles * tile;
constexpr int rows_at_once = 2 * tile;  ///< Of the Gram matrix: as many sums as hide how long one takes.
/// Part of the limit (of squares) below which a column goes: with its penalty it would count for 1e-5 of itself.
constexpr double as_good_as_nothing = 3e-3;

/// By rows, of whole tiles.
struct Matrix {
  double at[max_columns][max_columns];
};

int tiles_of(int columns) { return (columns + tile - 1) / tile; }

/// sums[k][b] = sum_j w_j x_k(j) y_b(j) for rows_at_once columns x and a tile of columns y, in rows that are pitch
/// apart.
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

/// The Gram matrix X^T W X, from the diagonal's tiles to the right.
void gram_matrix(const Window& window, const Real* weight, int tiles, Matrix& gram) {
  for (int a = 0; a < tiles * tile; a += rows_at_once)
    for (int b = a; b < tiles * tile; b += tile)
      tile_of_gram(window.design.data() + a, window.design.data() + b, static_cast<std::size_t>(window.pitch), weight,
                   window.padded, reinterpret_cast<double(*)[max_columns]>(&gram.at[a][b]));
}

/// A kept column's row of R, and behind it what it takes of each column of the design: its row of the inverse of R^T.
template <int tiles>
struct FactorRow {
  double at[2 * tiles * tile];
};

/// The row behind the first `above`, of column a, less those, each times its own value in that column.
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

/// What is left of a column beside those before it.
struct Remainder {
  double inverse_length = 0;  ///< 1 / (length with the penalty); 0 where the column is as good as dependent.
  bool independent = false;   ///< More is left than the limits ask for.
};

/// rest and own: the squares of what is left of column a and of all of it; weight_sum: of the window.
Remainder remainder_of(double rest, double own, double weight_sum, bool is_feature, const DependenceLimits& limits) {
  const double little = std::max(limits.remainder * limits.remainder * own,
                                 is_feature ? limits.variation * limits.variation * weight_sum : 0.0);
  const double square = rest + little * (little / rest);
  // The length and its inverse must be values of the storage type, or q overflows.
  const bool keep =
      rest > as_good_as_nothing * little && std::isnormal(rest) && std::isnormal(static_cast<Real>(std::sqrt(square)));
  return {keep ? 1 / std::sqrt(square) : 0, keep && rest > little};
}

/// Factors the Gram matrix into R^T R, row by row from the top, and sets what factor keeps and its rank. inverse
/// becomes R^-1: row b tells how much of column b each kept column of Q takes.
template <int tiles>
void invert_factor(const Matrix& gram, const BasisLayout& layout, const DependenceLimits& limits, NestedFactor& factor,
                   Matrix& inverse) {
  constexpr int width = tiles * tile;
  FactorRow<tiles> rows[width];
  for (int a = 0; a < factor.columns; ++a) {
    double* const row = rows[factor.kept].at;  // taken by the next column if this one goes
    const int first = a / tile * tile;         // the Gram matrix has nothing before
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

/// A tile of columns of q = X R^-1 for all pixels: of the first `columns` of X, which are all that these take of.
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

/// How many columns of the design, from the first, the tile of q that begins with its column k takes of.
int columns_taken(const NestedFactor& factor, int k) {
  return factor.kept_column[static_cast<std::size_t>(std::min(k + tile, factor.kept) - 1)] + 1;
}

template <int tiles>
void factorise_tiles(const Window& window, const Real* weight, NestedFactor& factor, const DependenceLimits& limits) {
  Matrix gram, inverse;
  gram_matrix(window, weight, tiles, gram);
  invert_factor<tiles>(gram, window.layout, limits, factor, inverse);
  for (int k = 0; k < factor.kept; k += tile)
    tile_of_q(window.design.data(), static_cast<std::size_t>(window.pitch),
              reinterpret_cast<const double(*)[max_columns]>(&inverse.at[0][k]), columns_taken(factor, k),
              window.padded, factor.q.data() + k);
}

POLYRECON_SIMD void multiply(const Real* a, const Real* b, double* product, int rows) {
  for (int j = 0; j < rows; ++j) product[j] = static_cast<double>(a[j]) * static_cast<double>(b[j]);
}

POLYRECON_SIMD void multiply_by(const Real* factor, double* y, int rows) {
  for (int j = 0; j < rows; ++j) y[j] *= static_cast<double>(factor[j]);
}

/// sums[a] = sum_j w_j q_a(j) y(j) for a tile of columns.
POLYRECON_SIMD void tile_sums(const Real* q, std::size_t pitch, const Real* weight, const Real* y, int rows,
                              double* sums) {
  Doubles s = {};
  for (int j = 0; j < rows; ++j, q += pitch)
    s += static_cast<double>(weight[j]) * static_cast<double>(y[j]) *
         __builtin_convertvector(*reinterpret_cast<const StoredReals*>(q), Doubles);
  *reinterpret_cast<StoredDoubles*>(sums) = s;
}

/// The same, weighted before, for six or three y, and then for three with the squares of q: sums[..][k] on.
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

/// Sums of the kept columns, to where the design has these; zero for the others.
void spread(const double* of_kept, const NestedFactor& factor, double* of_all) {
  std::fill_n(of_all, factor.columns, 0.0);
  for (std::size_t k = 0; k < static_cast<std::size_t>(factor.kept); ++k) of_all[factor.kept_column[k]] = of_kept[k];
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
  spread(sums, factor, z);
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
    spread(sums[c], factor, z[c]);
    if (with_guess) spread(sums[3 + c], factor, guess_z[c]);
    spread(sums[6 + c], factor, s2[c]);
  }
}

}  // namespace polyrecon
