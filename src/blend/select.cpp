#include "blend/select.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/gaussian.h"
#include "core/halves.h"
#include "core/near_best.h"
#include "core/parallel.h"
#include "core/pi.h"
#include "core/real.h"
#include "core/tiles.h"

namespace polyrecon {
namespace {

constexpr double brightness_sigma = 1;
constexpr double tie = 1e-3;  // the best candidate is the mean of those whose risk is within this of the least one
// Limits of the relative noise variance, which keep shares finite and above zero.
constexpr Real least_relative_variance = Real(1e-12), most_relative_variance = Real(1e12);
constexpr std::size_t largest_tile = std::size_t{1024} * 1024;  // pixels; larger ones are not faster

/// 1 / (brightness^2 + epsilon). The square is smoothed so that one dark pixel does not dominate the risk of its
/// neighbourhood.
Image inverse_brightness(const Image& brightness, double epsilon, const Image& mask) {
  Image out = brightness;
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < out.width(); ++x) out.at(x, y, c) *= out.at(x, y, c);
  });
  out = gaussian_blur(out, brightness_sigma, mask);
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < out.width(); ++x)
        out.at(x, y, c) = static_cast<Real>(1 / (static_cast<double>(out.at(x, y, c)) + epsilon));
  });
  return out;
}

/// The risk of a candidate before it is averaged.
Image raw_risk(const HalfPair& pair, const Candidate& candidate, const Image& scale) {
  Image out(scale.width(), scale.height(), 1);
  for_rows(out.height(), [&](int y) {
    Real* risk = out.row(0, y);
    for (int c = 0; c < 3; ++c) {
      const Real *fa = candidate.half[0].row(c, y), *fb = candidate.half[1].row(c, y);
      const Real *a = pair.color[0].row(c, y), *b = pair.color[1].row(c, y), *s = scale.row(c, y);
      for (int x = 0; x < out.width(); ++x) {
        const Real da = fa[x] - b[x], db = fb[x] - a[x], d = fa[x] - fb[x];
        risk[x] += (Real(0.5) * (da * da + db * db) - Real(0.25) * d * d) * s[x] * Real(1.0 / 3);
      }
    }
  });
  return out;
}

/// The best candidate of each pixel, which the others are compared with.
struct Best {
  Image raw;   ///< Risk before averaging; the mean over the candidates that are about equally good.
  Image risk;  ///< The least averaged risk.
};

/// exp(-z^2 / 2), z = D / SE, of a candidate compared with the best one of each pixel.
Image likelihood(const Image& raw, const Image& risk, const Best& best, const SelectParams& params, const Image& mask) {
  const int width = raw.width(), height = raw.height();
  Image moments(width, height, 2);
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const Real difference = raw.at(x, y, 0) - best.raw.at(x, y, 0);
      moments.at(x, y, 0) = difference;
      moments.at(x, y, 1) = difference * difference;
    }
  });
  moments = gaussian_blur(moments, params.risk_sigma, mask);
  // The number of independent pixels whose mean has the variance of the Gaussian average.
  const double independent = 4 * pi * params.risk_sigma * params.risk_sigma;
  Image out(width, height, 1);
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const double mean = moments.at(x, y, 0), square = moments.at(x, y, 1);
      const double error = std::sqrt(std::max(0.0, square - mean * mean) / independent);
      const double above = static_cast<double>(risk.at(x, y, 0)) - static_cast<double>(best.risk.at(x, y, 0));
      const double z = above / (error + 1e-30);
      out.at(x, y, 0) = static_cast<Real>(above > 0 ? std::exp(-0.5 * z * z) : 1.0);
    }
  });
  return out;
}

/// Divides the shares of a candidate by the standard deviation s of its noise, which is relative like the risk.
void divide_by_noise(const Image& variance, const Image& scale, double sigma, const Image& mask, Image& shares) {
  if (variance.empty()) return;
  Image relative(shares.width(), shares.height(), 1);
  for_rows(shares.height(), [&](int y) {
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < shares.width(); ++x) relative.at(x, y, 0) += variance.at(x, y, c) * scale.at(x, y, c);
  });
  relative = gaussian_blur(relative, sigma, mask);
  for_rows(shares.height(), [&](int y) {
    for (int x = 0; x < shares.width(); ++x) {
      const Real v = relative.at(x, y, 0) + least_relative_variance;
      shares.at(x, y, 0) /= std::sqrt(
          v < most_relative_variance ? v : most_relative_variance);  // also where v is NaN, as radiance underflows
    }
  });
}

Best best_of(const std::vector<Image>& raw, const std::vector<Image>& risk) {
  Best out{Image(raw[0].width(), raw[0].height(), 1), risk[0]};
  for_rows(out.raw.height(), [&](int y) {
    for (int x = 0; x < out.raw.width(); ++x) {
      Real& least = out.risk.at(x, y, 0);
      for (const Image& r : risk) least = std::min(least, r.at(x, y, 0));
      const double tolerance = tie * std::abs(static_cast<double>(least));
      double sum = 0, total = 0;
      for (std::size_t k = 0; k < raw.size(); ++k) {
        const double above = static_cast<double>(risk[k].at(x, y, 0)) - static_cast<double>(least);
        const double share = share_near_best(above, tolerance);
        sum += share * static_cast<double>(raw[k].at(x, y, 0));
        total += share;
      }
      out.raw.at(x, y, 0) = static_cast<Real>(sum / total);
    }
  });
  return out;
}

/// Adds an image of a candidate to the average, after `map` has been applied to each value.
template <typename Map>
void add_share(const Image& in, const Image& shares, const Image& total, const Map& map, Image& out) {
  if (in.empty()) return;
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x)
        out.at(x, y, c) += map(in.at(x, y, c)) * (shares.at(x, y, 0) / total.at(x, y, 0));
  });
}

void square(Image& image) {
  for_rows(image.height(), [&](int y) {
    for (int c = 0; c < image.channels(); ++c)
      for (int x = 0; x < image.width(); ++x) {
        const double v = image.at(x, y, c);
        image.at(x, y, c) = storable(v * v);
      }
  });
}

}  // namespace

int select_halo(const SelectParams& params) {
  // Smoothing of the shares + average of the squared difference to the best risk + average of the risk + smoothing of
  // the brightness.
  return gaussian_radius(params.map_sigma) + 2 * gaussian_radius(params.risk_sigma) + gaussian_radius(brightness_sigma);
}

Candidate select(const HalfPair& pair, const Image& brightness, const std::vector<Candidate>& candidates,
                 const SelectParams& params) {
  assert(!candidates.empty());
  const int width = brightness.width(), height = brightness.height();
  const Image scale = inverse_brightness(brightness, pair.epsilon, pair.sampled);
  std::vector<Image> raw, risk, shares;
  for (const Candidate& candidate : candidates) {
    raw.push_back(raw_risk(pair, candidate, scale));
    risk.push_back(gaussian_blur(raw.back(), params.risk_sigma, pair.sampled));
  }
  const Best best = best_of(raw, risk);
  Image total(width, height, 1);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    Image share = likelihood(raw[k], risk[k], best, params, pair.sampled);
    divide_by_noise(candidates[k].variance, scale, params.risk_sigma, pair.sampled, share);
    shares.push_back(gaussian_blur(share, params.map_sigma, pair.sampled));
    for_rows(height, [&](int y) {
      for (int x = 0; x < width; ++x) total.at(x, y, 0) += shares[k].at(x, y, 0);
    });
  }
  if (!pair.sampled.empty())  // far from the mask all shares are 0
    std::replace(total.plane(0), total.plane(0) + total.pixels(), Real(0), Real(1));
  Candidate out = make_candidate(width, height, candidates[0].half[0].channels());
  const auto value = [](Real v) { return v; };
  const auto root = [](Real v) { return std::sqrt(v); };  // biases are averaged, not their squares; see BlendedFit
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    for (std::size_t h = 0; h < 2; ++h) add_share(candidates[k].half[h], shares[k], total, value, out.half[h]);
    add_share(candidates[k].squared_bias, shares[k], total, root, out.squared_bias);
    add_share(candidates[k].variance, shares[k], total, value, out.variance);
    add_share(candidates[k].order, shares[k], total, value, out.order);
  }
  square(out.squared_bias);
  return out;
}

std::size_t select_channels(std::size_t candidates, std::size_t color_channels) {
  constexpr std::size_t risks = 2, share = 1;  // per candidate: raw and smoothed
  constexpr std::size_t inverse_brightness = 3, best = 2, total_share = 1;
  // Moments with both directions of their blur, and the likelihood made of them; gone before the result is allocated.
  constexpr std::size_t moments = std::size_t{3} * 2, likelihood = 1;
  return candidates * (risks + share) + inverse_brightness + best + total_share +
         std::max(moments + likelihood, candidate_channels(color_channels));
}

std::array<Image, 2> select_correction(const HalfPair& pair, const std::array<Image, 2>& halves,
                                       const Corrections& corrections, const SelectParams& params,
                                       std::size_t max_bytes) {
  const int width = pair.width(), height = pair.height(), channels = halves[0].channels();
  std::array<Image, 2> out{Image(width, height, channels), Image(width, height, channels)};
  const std::size_t pixels =
      std::min(max_bytes / correction_bytes_per_pixel(channels, corrections.count), largest_tile);
  for (const Tile& tile : make_tiles(out[0].bounds(), select_halo(params) + corrections.halo, 1, pixels)) {
    const Rect& r = tile.padded;
    const HalfPair part{{crop(pair.color[0], r, 0, channels), crop(pair.color[1], r, 0, channels)},
                        {},
                        {},
                        pair.epsilon,
                        crop(pair.sampled, r)};
    std::vector<Candidate> candidates{{{crop(halves[0], r), crop(halves[1], r)}, {}, {}, {}}};
    for (std::array<Image, 2>& corrected : corrections.make(candidates[0].half, r))
      candidates.push_back({std::move(corrected), {}, {}, {}});
    const Candidate best = select(part, mean_of_halves(candidates[0].half, 3), candidates, params);
    for (std::size_t h = 0; h < 2; ++h) paste(best.half[h], inside(tile), out[h], tile.core.x0, tile.core.y0);
  }
  return out;
}

std::size_t correction_bytes_per_pixel(int channels, std::size_t corrections) {
  const auto colors = static_cast<std::size_t>(channels);
  const std::size_t noisy_halves = 2 * colors, candidates = corrections + 1, candidate_halves = 2 * colors;
  constexpr std::size_t brightness = 3;
  // Images that `make` works with are gone before select runs, which needs more.
  return sizeof(Real) *
         (noisy_halves + candidates * candidate_halves + brightness + select_channels(candidates, colors));
}

}  // namespace polyrecon
