#include "noise/variance_floor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/simd.h"

namespace polyrecon {
namespace {

constexpr int radius = 2, side = 2 * radius + 1;
constexpr Real part_of_mean = Real(0.5);  // of the squared mean standard deviation

/// Median of five without branches, by the middle of a sorting network.
inline Real median_of_5(Real a, Real b, Real c, Real d, Real e) {
  const Real low_ab = a < b ? a : b, high_ab = a < b ? b : a, low_cd = c < d ? c : d, high_cd = c < d ? d : c;
  const Real f = low_ab > low_cd ? low_ab : low_cd, g = high_ab < high_cd ? high_ab : high_cd;
  const Real low = f < g ? f : g, high = f < g ? g : f;
  return e < low ? low : (e > high ? high : e);
}

/// The median of five rows in each column.
POLYRECON_SIMD void medians_of_columns(const Real* const* rows, Real* median, int n) {
  for (int x = 0; x < n; ++x) median[x] = median_of_5(rows[0][x], rows[1][x], rows[2][x], rows[3][x], rows[4][x]);
}

/// The mean square root of five rows in each column.
POLYRECON_SIMD void mean_roots_of_columns(const Real* const* rows, Real* mean_root, int n) {
  for (int x = 0; x < n; ++x) {
    const Real a = rows[0][x], b = rows[1][x], c = rows[2][x], d = rows[3][x], e = rows[4][x];
    mean_root[x] = (std::sqrt(a) + std::sqrt(b) + std::sqrt(c) + std::sqrt(d) + std::sqrt(e)) * Real(0.2);
  }
}

/// The median of five consecutive values for each of n pixels. in begins `radius` values before the first pixel.
POLYRECON_SIMD void medians_along(const Real* in, Real* median, int n) {
  for (int x = 0; x < n; ++x) median[x] = median_of_5(in[x], in[x + 1], in[x + 2], in[x + 3], in[x + 4]);
}

/// Computes one row of the result. column_median, row_median: the medians of the columns' and of the rows' medians.
/// mean_roots: mean square roots of the columns, from `radius` values before the first pixel.
POLYRECON_SIMD void floor_row(const Real* variance, const Real* column_median, const Real* row_median,
                              const Real* mean_roots, Real* out, int n) {
  for (int x = 0; x < n; ++x) {
    const Real median = Real(0.5) * (column_median[x] + row_median[x]);
    const Real root =
        (mean_roots[x] + mean_roots[x + 1] + mean_roots[x + 2] + mean_roots[x + 3] + mean_roots[x + 4]) * Real(0.2);
    const Real mean = part_of_mean * root * root;
    const Real least = median > mean ? median : mean;
    out[x] = variance[x] > least ? variance[x] : least;
  }
}

/// The five rows around row y of a channel; border rows are repeated.
void rows_around(const Image& image, int c, int y, const Real** rows) {
  for (int k = 0; k < side; ++k) rows[k] = image.row(c, std::clamp(y + k - radius, 0, image.height() - 1));
}

/// Fills the first and the last `radius` values of a line with the values next to them.
void repeat_ends(std::vector<Real>& line) {
  std::fill_n(line.begin(), radius, line[radius]);
  std::fill_n(line.end() - radius, radius, *(line.end() - radius - 1));
}

Image medians_of_rows(const Image& image) {
  Image out(image.width(), image.height(), image.channels());
  for_rows(out.height(), [&](int y) {
    std::vector<Real> line(static_cast<std::size_t>(image.width() + 2 * radius));
    for (int c = 0; c < out.channels(); ++c) {
      const Real* in = image.row(c, y);
      std::copy(in, in + image.width(), line.begin() + radius);
      repeat_ends(line);
      medians_along(line.data(), out.row(c, y), image.width());
    }
  });
  return out;
}

}  // namespace

Image floor_variance(const Image& variance) {
  Image out(variance.width(), variance.height(), variance.channels());
  const Image row_medians = medians_of_rows(variance);
  const int width = variance.width();
  for_rows(out.height(), [&](int y) {
    const auto columns = static_cast<std::size_t>(width);
    const std::size_t padded = columns + std::size_t{side} - 1;
    std::vector<Real> medians(padded), mean_roots(padded), column_median(columns), row_median(columns);
    for (int c = 0; c < out.channels(); ++c) {
      const Real* rows[side];
      rows_around(row_medians, c, y, rows);
      medians_of_columns(rows, row_median.data(), width);
      rows_around(variance, c, y, rows);
      medians_of_columns(rows, medians.data() + radius, width);
      mean_roots_of_columns(rows, mean_roots.data() + radius, width);
      repeat_ends(medians);
      repeat_ends(mean_roots);
      medians_along(medians.data(), column_median.data(), width);
      floor_row(variance.row(c, y), column_median.data(), row_median.data(), mean_roots.data(), out.row(c, y), width);
    }
  });
  return out;
}

}  // namespace polyrecon
