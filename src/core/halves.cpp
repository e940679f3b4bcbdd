#include "core/halves.h"

#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/relmse.h"

namespace polyrecon {
namespace {

// Of w from that of equal halves. Files of half floats round A, B and their mean.
constexpr double rounding = 0.01;
constexpr double largest_share = 0.98;  // Beyond it the halves contradict the mean.

/// Sums over a row of channel c for the least squares fit of w in mean - B = w (A - B), relative to the radiance.
struct ShareSums {
  double product = 0;  ///< (mean - B) (A - B)
  double square = 0;   ///< (A - B)^2
};

ShareSums share_sums(const Image& mean, const Image& half_a, const Image& half_b, int c, int y) {
  const Real *m = mean.row(c, y), *a = half_a.row(c, y), *b = half_b.row(c, y);
  ShareSums sums;
  for (int x = 0; x < mean.width(); ++x) {
    const double from_b = static_cast<double>(m[x]) - static_cast<double>(b[x]),
                 difference = static_cast<double>(a[x]) - static_cast<double>(b[x]),
                 weight = 1 / relmse_denominator(static_cast<double>(m[x]));
    if (!std::isfinite(from_b) || !std::isfinite(difference)) continue;
    sums.product += weight * from_b * difference;
    sums.square += weight * difference * difference;
  }
  return sums;
}

}  // namespace

double half_noise(const Image& mean, const Image& half_a, const Image& half_b) {
  std::vector<ShareSums> rows(static_cast<std::size_t>(mean.height()));
  for_rows(mean.height(), [&](int y) {
    for (int c = 0; c < mean.channels(); ++c) {
      const ShareSums row = share_sums(mean, half_a, half_b, c, y);
      rows[static_cast<std::size_t>(y)].product += row.product;
      rows[static_cast<std::size_t>(y)].square += row.square;
    }
  });
  ShareSums total;
  for (const ShareSums& row : rows) {
    total.product += row.product;
    total.square += row.square;
  }
  const double share = total.square > 0 ? total.product / total.square : 0.5;
  if (std::abs(share - 0.5) < rounding || share > largest_share || share < 1 - largest_share) return 2;
  return (1 / share + 1 / (1 - share)) / 2;
}

Image mean_of_halves(const std::array<Image, 2>& halves, int channels) {
  Image out(halves[0].width(), halves[0].height(), channels);
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < channels; ++c) {
      const Real *a = halves[0].row(c, y), *b = halves[1].row(c, y);
      Real* mean = out.row(c, y);
      for (int x = 0; x < out.width(); ++x) mean[x] = Real(0.5) * (a[x] + b[x]);
    }
  });
  return out;
}

}  // namespace polyrecon
