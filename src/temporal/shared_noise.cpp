#include "temporal/shared_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "core/gaussian.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "core/spectrum_corner.h"

namespace polyrecon {
namespace {

// Squared differences in units of what independent noise makes. A variance that is estimated from the image may be
// several times too high.
constexpr double shares_none = 0.4, shares_all = 0.2;
constexpr Real least_repeated = 0.25F;   // rho
constexpr Real most_of_noise = 0.8F;     // a variance that is estimated from the image may be too low
constexpr double most_rest = 4;          // in units of the noise: no block counts more
constexpr double one_seed = 0.8;         // of the noisy pixels
constexpr double around_block = 1;       // blocks
constexpr int shared_block = 16;         // pixels
constexpr double most_of_one_pixel = 5;  // squared difference, in units of its noise, that a pixel counts with at most

/// Squared differences of the means of both halves from the estimate's, in units of the variance of independent noise,
/// and 1; both 0 where there is neither noise nor an estimate. Independent noise makes 1 on average, shared noise 0.
Image noise_ratios(const HalfPair& pair, const Estimate& estimate) {
  Image out(pair.width(), pair.height(), 2);
  for_rows(out.height(), [&](int y) {
    for (int x = 0; x < out.width(); ++x) {
      const std::size_t i = out.index(x, y);
      if (!estimate.valid[i]) continue;
      double square = 0, noise = 0;
      for (int c = 0; c < 3; ++c) {
        double d = 0;
        for (std::size_t h = 0; h < 2; ++h)
          d += static_cast<double>(pair.color[h].plane(c)[i]) - static_cast<double>(estimate.color[h].plane(c)[i]);
        square += d * d / 4;
        noise += static_cast<double>(pair.variance.plane(c)[i] + estimate.variance.plane(c)[i]) / 2;
      }
      if (!(noise > least_variance)) continue;
      out.plane(0)[i] = static_cast<Real>(std::min(square / noise, most_of_one_pixel));
      out.plane(1)[i] = 1;
    }
  });
  return out;
}

/// Sums over a block, in the corner of the spectrum.
struct CornerSums {
  double own = 0, other = 0, product = 0;  ///< c_m^2, c_n^2, c_m c_n over RGB.
  double noise = 0;                        ///< Variance of the current frame's means.
};

/// Means of both halves at (x, y), of channel c.
double mean_of(const std::array<Image, 2>& color, std::size_t i, int c) {
  return (static_cast<double>(color[0].plane(c)[i]) + static_cast<double>(color[1].plane(c)[i])) / 2;
}

/// The corner of the spectrum of the means around (x, y); white noise keeps its variance.
double corner(const std::array<Image, 2>& color, int x, int y, int c) {
  return corner_of_spectrum([&](int i, int j) { return mean_of(color, color[0].index(x + i, y + j), c); }) /
         corner_gain;
}

/// Whether all pixels that corner() reads are seen in the neighbour.
bool all_valid(const Estimate& estimate, int x, int y) {
  for (int j = y - 1; j <= y + 2; ++j)
    for (int i = x - 1; i <= x + 2; ++i)
      if (!estimate.valid[estimate.variance.index(i, j)]) return false;
  return true;
}

CornerSums corner_sums(const HalfPair& pair, const Estimate& estimate, const Rect& block) {
  CornerSums sums;
  for (int y = std::max(block.y0, 1); y < std::min(block.y1, pair.height() - 2); ++y)
    for (int x = std::max(block.x0, 1); x < std::min(block.x1, pair.width() - 2); ++x) {
      if (!all_valid(estimate, x, y)) continue;
      for (int c = 0; c < 3; ++c) {
        const double m = corner(pair.color, x, y, c), n = corner(estimate.color, x, y, c);
        sums.own += m * m;
        sums.other += n * n;
        sums.product += m * n;
        sums.noise += static_cast<double>(pair.variance.plane(c)[pair.variance.index(x, y)]) / 2;
      }
    }
  return sums;
}

/// The similarity of two frames in a block.
struct Common {
  double rho;   ///< Correlation of all that they show.
  double rest;  ///< Difference between them, in units of the noise.
};

Common common(const CornerSums& sums) {
  const double rho = sums.product / std::sqrt(sums.own * sums.other);
  return {rho, std::min((1 - rho) * sums.own / sums.noise, most_rest)};
}

/// A pixel a block: common() and 1, or 0 where one of the frames has no noise.
Image common_blocks(const HalfPair& pair, const Places& neighbour) {
  static_assert(band_rows % shared_block == 0);
  const auto blocks = [](int pixels) { return (pixels + shared_block - 1) / shared_block; };
  Image out(blocks(pair.width()), blocks(pair.height()), 3);
  for (int y = 0; y < pair.height(); y += band_rows) {
    const Rect band{0, y, pair.width(), std::min(y + band_rows, pair.height())};
    const HalfPair part = crop(pair, band);
    const Estimate estimate = estimate_at({neighbour}, std::abs(neighbour.offset), band);
    for (const Rect& block : aligned_blocks(part.variance.bounds(), shared_block)) {
      const CornerSums sums = corner_sums(part, estimate, block);
      if (!(sums.noise > least_variance && sums.own > least_variance && sums.other > least_variance)) continue;
      const int column = block.x0 / shared_block, row = (y + block.y0) / shared_block;
      const Common found = common(sums);
      out.at(column, row, 0) = static_cast<Real>(found.rho);
      out.at(column, row, 1) = static_cast<Real>(found.rest);
      out.at(column, row, 2) = 1;
    }
  }
  return out;
}

/// Whether the neighbour repeats the noise in a block. Both frames show a texture too, so correlation alone does not
/// tell: what the frames do not have in common must also be less than the noise.
bool repeats(const Image& blocks, int column, int row) {
  const Real count = blocks.at(column, row, 2);
  return blocks.at(column, row, 0) > least_repeated * count && blocks.at(column, row, 1) < most_of_noise * count;
}

}  // namespace

double hide_repeated_noise(const HalfPair& pair, Places& neighbour) {
  const Image blocks = gaussian_blur(common_blocks(pair, neighbour), around_block);
  std::vector<unsigned char> seen = neighbour.seen;
  double noisy = 0, hidden = 0;
  for (int y = 0; y < pair.height(); ++y)
    for (int x = 0; x < pair.width(); ++x) {
      if (!is_noisy(pair.variance, x, y)) continue;
      noisy += 1;
      if (!repeats(blocks, x / shared_block, y / shared_block)) continue;
      hidden += 1;
      seen[pair.variance.index(x, y)] = 0;
    }
  // A seed holds for the whole frame. Moving parts repeat the noise only in part, so it may not be found in them.
  if (hidden > one_seed * noisy) std::fill(seen.begin(), seen.end(), static_cast<unsigned char>(0));
  neighbour.seen = std::move(seen);
  return hidden > one_seed * noisy ? 1 : noisy > 0 ? hidden / noisy : 0;
}

Image shared_noise(const HalfPair& pair, const Estimate& estimate) {
  const Image around = gaussian_blur(noise_ratios(pair, estimate), shared_sigma);
  Image out(around.width(), around.height(), 1);
  for (std::size_t i = 0; i < out.pixels(); ++i) {
    const auto count = static_cast<double>(around.plane(1)[i]);
    const double ratio = count > 0 ? static_cast<double>(around.plane(0)[i]) / count : 1;
    out.plane(0)[i] = static_cast<Real>(std::clamp((shares_none - ratio) / (shares_none - shares_all), 0.0, 1.0));
  }
  return out;
}

}  // namespace polyrecon
