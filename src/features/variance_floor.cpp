#include "features/variance_floor.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "core/simd.h"

namespace polyrecon {
namespace {

constexpr int radius = 2, side = 2 * radius + 1;
constexpr Real part_of_mean = Real(0.3);

/// Median of five by a sorting network's middle, free of branches.
inline Real median_of_5(Real a, Real b, Real c, Real d, Real e) {
  const Real low_ab = a < b ? a : b, high_ab = a < b ? b : a, low_cd = c < d ? c : d, high_cd = c < d ? d : c;
  const Real f = low_ab > low_cd ? low_ab : low_cd, g = high_ab < high_cd ? high_ab : high_cd;
  const Real low = f < g ? f : g, high = f < g ? g : f;
  return e < low ? low : (e > high ? high : e);
}

/// Per column the median and the mean of five rows.
POLYRECON_SIMD void columns_of_5(const Real* const* rows, Real* median, Real* mean, int n) {
  for (int x = 0; x < n; ++x) {
    const Real a = rows[0][x], b = rows[1][x], c = rows[2][x], d = rows[3][x], e = rows[4][x];
    median[x] = median_of_5(a, b, c, d, e);
    mean[x] = (a + b + c + d + e) * Real(0.2);
  }
}

/// medians, means: columns from radius before the first to radius after the last of the n results.
POLYRECON_SIMD void floor_row(const Real* variance, const Real* medians, const Real* means, Real* out, int n) {
  for (int x = 0; x < n; ++x) {
    const Real median = median_of_5(medians[x], medians[x + 1], medians[x + 2], medians[x + 3], medians[x + 4]);
    const Real mean = (means[x] + means[x + 1] + means[x + 2] + means[x + 3] + means[x + 4]) * Real(0.2) * part_of_mean;
    const Real least = median > mean ? median : mean;
    out[x] = variance[x] > least ? variance[x] : least;
  }
}

}  // namespace

Image floor_variance(const Image& variance) {
  Image out(variance.width(), variance.height(), variance.channels());
  const int width = variance.width();
  Progress silent;
  parallel_for(static_cast<std::size_t>(out.height()), silent, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const auto padded = static_cast<std::size_t>(width + 2 * radius);
    std::vector<Real> medians(padded), means(padded);
    for (int c = 0; c < out.channels(); ++c) {
      const Real* rows[side];
      for (int k = 0; k < side; ++k) rows[k] = variance.row(c, std::clamp(y + k - radius, 0, variance.height() - 1));
      columns_of_5(rows, medians.data() + radius, means.data() + radius, width);
      for (std::vector<Real>* line : {&medians, &means}) {
        std::fill_n(line->begin(), radius, (*line)[radius]);
        std::fill_n(line->end() - radius, radius, *(line->end() - radius - 1));
      }
      floor_row(variance.row(c, y), medians.data(), means.data(), out.row(c, y), width);
    }
  });
  return out;
}

}  // namespace polyrecon
