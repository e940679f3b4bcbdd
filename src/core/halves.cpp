#include "core/halves.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/parallel.h"
#include "core/relmse.h"
#include "core/repair.h"

namespace polyrecon {
namespace {

// Deviation of w from that of equal halves. Files of half floats round A, B and their mean.
constexpr double rounding = 0.01;
constexpr double largest_share = 0.98;  // Beyond it the mean is of one half alone, or of neither.
constexpr double exactly = 1e-4;        // share of the squares that the fit of w may leave

/// Sums over a row of channel c for the least squares fit of w in mean - B = w (A - B), relative to the radiance.
struct ShareSums {
  double product = 0;  ///< (mean - B) (A - B)
  double square = 0;   ///< (A - B)^2
  double target = 0;   ///< (mean - B)^2
};

/// The least squares fit of w.
struct Share {
  double of_a = 0.5;  ///< A half where the halves do not differ.
  bool exact = true;  ///< The mean is w A + (1 - w) B, rather than another picture of the scene.
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
    sums.target += weight * from_b * from_b;
  }
  return sums;
}

/// The fit to all pixels and channels.
Share share_of(const Image& mean, const Image& half_a, const Image& half_b) {
  std::vector<ShareSums> rows(static_cast<std::size_t>(mean.height()));
  for_rows(mean.height(), [&](int y) {
    for (int c = 0; c < mean.channels(); ++c) {
      const ShareSums row = share_sums(mean, half_a, half_b, c, y);
      rows[static_cast<std::size_t>(y)].product += row.product;
      rows[static_cast<std::size_t>(y)].square += row.square;
      rows[static_cast<std::size_t>(y)].target += row.target;
    }
  });
  ShareSums total;
  for (const ShareSums& row : rows) {
    total.product += row.product;
    total.square += row.square;
    total.target += row.target;
  }
  if (!(total.square > 0)) return {};
  const double share = total.product / total.square;
  return {share, total.target - share * total.product < exactly * total.square};
}

bool is_share(double share) { return share <= largest_share && share >= 1 - largest_share; }

constexpr int block_side = 8;              // pixels; small enough to see a bucket that failed
constexpr double surely_not_noise = 5;     // standard deviations; the pixel filter correlates neighbours by about 2
constexpr double smallest_half = 0x1p-24;  // steps in which half floats are rounded in the dark

/// The error that half floats may have made of a small value; 0 where they hold no value of the image.
double rounding_in_the_dark(const Image& image) {
  std::vector<double> rows(static_cast<std::size_t>(image.height()), 0.0);
  for_rows(image.height(), [&](int y) {
    double& largest = rows[static_cast<std::size_t>(y)];
    for (int c = 0; c < image.channels(); ++c)
      for (int x = 0; x < image.width(); ++x)
        if (const Real v = image.at(x, y, c); usable(v)) largest = std::max(largest, std::abs(static_cast<double>(v)));
  });
  const double largest = rows.empty() ? 0 : *std::max_element(rows.begin(), rows.end());
  return largest < smallest_half ? 0 : smallest_half;
}

/// Sums over pixels of one channel.
struct Disagreement {
  double rest = 0;     ///< mean - (A + B) / 2
  double spread = 0;   ///< |A - B| / 2
  double squares = 0;  ///< (A - B)^2 / 4: the variance of (A + B) / 2
  double energy = 0;   ///< |mean|
  double rounding = 0;

  void add(Real mean, Real a, Real b, double rounding_of_pixel) {
    if (!usable(mean)) return;
    const double m = static_cast<double>(mean);
    energy += std::abs(m);
    rounding += rounding_of_pixel;
    const bool known = usable(a) && usable(b);
    const double from_a = known ? static_cast<double>(a) : 0, from_b = known ? static_cast<double>(b) : 0,
                 difference = (from_a - from_b) / 2;
    rest += m - (from_a + from_b) / 2;
    spread += std::abs(difference);
    squares += difference * difference;
  }
  void add(const Disagreement& other) {
    rest += other.rest;
    spread += other.spread;
    squares += other.squares;
    energy += other.energy;
    rounding += other.rounding;
  }
  bool exceeds(double noise) const {
    return std::abs(rest) > std::min(spread, noise) + contradicting_energy * energy + rounding;
  }
};

/// The blocks of one row of blocks.
struct BlockRow {
  Disagreement all;
  bool exceeds = false;  ///< In some block.
};

BlockRow block_row(const Image& mean, const Image& half_a, const Image& half_b, double rounding_of_pixel, int c,
                   int first_row) {
  BlockRow out;
  const int end_row = std::min(first_row + block_side, mean.height());
  for (int first = 0; first < mean.width(); first += block_side) {
    Disagreement block;
    for (int y = first_row; y < end_row; ++y)
      for (int x = first; x < std::min(first + block_side, mean.width()); ++x)
        block.add(mean.at(x, y, c), half_a.at(x, y, c), half_b.at(x, y, c), rounding_of_pixel);
    out.exceeds |= block.exceeds(block.spread);
    out.all.add(block);
  }
  return out;
}

}  // namespace

double known_variance(const Pass& pass, int c, std::size_t i) {
  const auto usable_or_none = [](double variance) { return std::isfinite(variance) ? std::max(variance, 0.0) : 0; };
  if (!pass.variance.empty() && usable(pass.variance.plane(c)[i]))
    return usable_or_none(static_cast<double>(pass.variance.plane(c)[i]));
  if (!pass.has_halves()) return 0;
  return usable_or_none(variance_of_mean<double>(pass.half_a.plane(c)[i], pass.half_b.plane(c)[i]));
}

bool contradict(const Image& mean, const Image& half_a, const Image& half_b) {
  const Share share = share_of(mean, half_a, half_b);
  if (share.exact && !is_share(share.of_a)) return true;
  const auto rows = static_cast<std::size_t>((mean.height() + block_side - 1) / block_side);
  const double rounding_of_pixel = rounding_in_the_dark(mean);
  std::vector<BlockRow> blocks(rows * static_cast<std::size_t>(mean.channels()));
  in_parallel(blocks.size(), [&](std::size_t k) {
    blocks[k] = block_row(mean, half_a, half_b, rounding_of_pixel, static_cast<int>(k / rows),
                          static_cast<int>(k % rows) * block_side);
  });
  for (auto channel = blocks.begin(); channel != blocks.end(); channel += static_cast<std::ptrdiff_t>(rows)) {
    Disagreement all;
    for (auto row = channel; row != channel + static_cast<std::ptrdiff_t>(rows); ++row) {
      if (row->exceeds) return true;
      all.add(row->all);
    }
    if (all.exceeds(surely_not_noise * std::sqrt(all.squares))) return true;
  }
  return false;
}

double half_noise(const Image& mean, const Image& half_a, const Image& half_b) {
  const double share = share_of(mean, half_a, half_b).of_a;
  if (std::abs(share - 0.5) < rounding || !is_share(share)) return 2;
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
