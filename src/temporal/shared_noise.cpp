#include "temporal/shared_noise.h"

#include <algorithm>
#include <array>

#include "core/gaussian.h"
#include "core/parallel.h"
#include "core/rect.h"

namespace polyrecon {
namespace {

// A variance that is estimated from the image may be several times too high.
constexpr Sharing seeds_differ{0.4, 0.2}, one_seed{0.9, 0.45};
constexpr double one_seed_share = 0.1;   // of the noisy pixels
constexpr int shared_block = 16;         // pixels
constexpr double most_of_one_pixel = 5;  // squared difference, in units of its noise, that a pixel counts with at most
constexpr double tiny = 1e-30;
constexpr int band_rows = 256;  // rows that are looked at together; a multiple of a block

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
      if (!(noise > tiny)) continue;
      out.plane(0)[i] = static_cast<Real>(std::min(square / noise, most_of_one_pixel));
      out.plane(1)[i] = 1;
    }
  });
  return out;
}

/// Sums of an image's channels over a block.
std::array<double, 2> sums_over(const Image& image, const Rect& block) {
  std::array<double, 2> sums{};
  for (int c = 0; c < 2; ++c)
    for (int y = block.y0; y < block.y1; ++y)
      for (int x = block.x0; x < block.x1; ++x)
        sums[static_cast<std::size_t>(c)] += static_cast<double>(image.at(x, y, c));
  return sums;
}

/// Share of the noisy pixels in blocks that surely share their noise with the frames k before and after.
double share_of_shared_noise(const HalfPair& pair, const std::vector<Places>& places, int k) {
  double noisy = 0, shared = 0;
  for (int y = 0; y < pair.height(); y += band_rows) {
    const Rect band{0, y, pair.width(), std::min(y + band_rows, pair.height())};
    const Estimate estimate = estimate_at(places, k, band);
    if (estimate.valid.empty()) return 0;
    const Image ratios = noise_ratios(crop(pair, band), estimate);
    for (const Rect& block : aligned_blocks(ratios.bounds(), shared_block)) {
      const auto [sum, count] = sums_over(ratios, block);
      noisy += count;
      if (sum < seeds_differ.full * count) shared += count;
    }
  }
  return noisy > 0 ? shared / noisy : 0;
}

}  // namespace

const Sharing& sharing_of(const HalfPair& pair, const std::vector<Places>& places, int radius) {
  // At every distance, as a lamp that flashes hides from every other frame that the noise is the same.
  for (int k = 1; k <= radius; ++k)
    if (share_of_shared_noise(pair, places, k) > one_seed_share) return one_seed;
  return seeds_differ;
}

Image shared_noise(const HalfPair& pair, const Estimate& estimate, const Sharing& sharing) {
  const Image around = gaussian_blur(noise_ratios(pair, estimate), shared_sigma);
  Image out(around.width(), around.height(), 1);
  for (std::size_t i = 0; i < out.pixels(); ++i) {
    const auto count = static_cast<double>(around.plane(1)[i]);
    const double ratio = count > 0 ? static_cast<double>(around.plane(0)[i]) / count : 1;
    out.plane(0)[i] = static_cast<Real>(std::clamp((sharing.none - ratio) / (sharing.none - sharing.full), 0.0, 1.0));
  }
  return out;
}

}  // namespace polyrecon
