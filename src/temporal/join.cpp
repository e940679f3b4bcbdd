#include "temporal/join.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/gaussian.h"
#include "core/parallel.h"
#include "core/pi.h"
#include "core/rect.h"
#include "polyrecon/error.h"
#include "temporal/estimate.h"
#include "temporal/follow.h"
#include "temporal/neighbour.h"
#include "temporal/shared_noise.h"
#include "temporal/surface_change.h"

namespace polyrecon {
namespace {

constexpr double ratio_sigma = 2;  // pixels; variances are averaged before they are compared, as single ones are noisy
// K: variance of a pixel over that of the fitted image; about the number of pixels that a fit averages.
constexpr double noise_of_fit = 30;
constexpr double agreement_sigma = 16;  // pixels

/// The difference of a half from its estimate. Channels: difference RGB, the sum over RGB of its noise variance, and 1;
/// all zero where the estimate is not valid.
Image differences(const HalfPair& pair, const Estimate& estimate, std::size_t half) {
  Image out(pair.width(), pair.height(), 5);
  for_rows(out.height(), [&](int y) {
    for (int x = 0; x < out.width(); ++x) {
      const std::size_t i = out.index(x, y);
      if (!estimate.valid[i]) continue;
      Real noise = 0;
      for (int c = 0; c < 3; ++c) {
        out.plane(c)[i] = pair.color[half].plane(c)[i] - estimate.color[half].plane(c)[i];
        noise += pair.variance.plane(c)[i] + estimate.variance.plane(c)[i];
      }
      out.plane(3)[i] = noise;
      out.plane(4)[i] = 1;
    }
  });
  return out;
}

double squared(const Image& d, std::size_t i) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += static_cast<double>(d.plane(c)[i]) * static_cast<double>(d.plane(c)[i]);
  return sum;
}

/// The product over all scales of exp(-max(0, change - accept) / softness), 1 channel.
Image gate(const Image& difference, const TemporalParams& p) {
  Image excess(difference.width(), difference.height(), 1);
  const auto add = [&](const Image& d, const Image& floor, double kept) {
    for_rows(d.height(), [&](int y) {
      for (int x = 0; x < d.width(); ++x) {
        const std::size_t i = d.index(x, y);
        if (!(d.plane(4)[i] > 0)) continue;
        // Difference and noise are sums over the valid pixels only, with the same weights.
        const double noise = std::max(static_cast<double>(d.plane(3)[i]), static_cast<double>(floor.plane(3)[i]));
        const double change = squared(d, i) / std::max(kept * noise, least_variance);
        excess.plane(0)[i] += static_cast<Real>(std::max(0.0, change - p.accept) / p.softness);
      }
    });
  };
  // The variance of a single pixel may be far too low, so half of the average around it is the least that counts.
  Image around = gaussian_blur(difference, 1);
  for (std::size_t i = 0; i < around.pixels(); ++i) around.plane(3)[i] *= Real(0.5);
  add(difference, around, 1);
  for (const double sigma : p.scales) {
    const Image d = gaussian_blur(difference, sigma);
    add(d, d, 1 / (4 * pi * sigma * sigma));
  }
  for_rows(excess.height(), [&](int y) {
    for (int x = 0; x < excess.width(); ++x)
      excess.at(x, y, 0) = difference.at(x, y, 4) > 0 ? std::exp(-excess.at(x, y, 0)) : Real(0);
  });
  return excess;
}

Image sum_of_channels(const Image& image) {
  Image out(image.width(), image.height(), 1);
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i) out.plane(0)[i] += image.plane(c)[i];
  return out;
}

/// Running sums of one half over the pixel itself (with w = 1) and the estimates.
struct Sums {
  Image color, variance, weight;  ///< sum w y, sum w^2 Var, sum w
};

void add_estimate(const Estimate& estimate, std::size_t half, const Image& weight, Sums& sums) {
  for_rows(weight.height(), [&](int y) {
    for (int x = 0; x < weight.width(); ++x) {
      const std::size_t i = weight.index(x, y);
      const Real w = weight.plane(0)[i];
      if (w == 0) continue;
      for (int c = 0; c < sums.color.channels(); ++c) sums.color.plane(c)[i] += w * estimate.color[half].plane(c)[i];
      for (int c = 0; c < 3; ++c) sums.variance.plane(c)[i] += w * w * estimate.variance.plane(c)[i];
      sums.weight.plane(0)[i] += w;
    }
  });
}

/// The squared error e^2 of an estimate that is not noise, 1 channel: the part of the squared difference that noise
/// does not explain, such as the error of a texture sampled between its pixels.
Image excess_error(const Image& difference) {
  Image excess(difference.width(), difference.height(), 1);
  for (std::size_t i = 0; i < excess.pixels(); ++i)
    excess.plane(0)[i] = static_cast<Real>(squared(difference, i)) - difference.plane(3)[i];
  excess = gaussian_blur(excess, ratio_sigma);
  for (std::size_t i = 0; i < excess.pixels(); ++i) excess.plane(0)[i] = std::max(Real(0), excess.plane(0)[i]);
  return excess;
}

/// Radiance squared, summed over RGB, 1 channel: an average around each pixel of one half.
Image square_of_radiance(const Image& color) {
  Image out(color.width(), color.height(), 1);
  const Image mean = gaussian_blur(crop(color, color.bounds(), 0, 3), ratio_sigma);
  for (std::size_t i = 0; i < out.pixels(); ++i) out.plane(0)[i] = static_cast<Real>(squared(mean, i));
  return out;
}

/// Shares of the pixels around a pixel that agree with the neighbour: up to `none` the neighbour's weight is 0, from
/// `full` on it is not lowered.
struct Trust {
  double none, full;
};
// Some pixels agree by chance: after a cut, and in patterns that move without vectors. Vectors make this rare.
constexpr Trust with_vectors{0.25, 0.5}, without_vectors{0.6, 0.8};

/// Whether there are vectors that are not all 0; such ones say no more than none.
bool has_vectors(const Image& motion) {
  for (int c = 0; c < motion.channels(); ++c)
    if (std::any_of(motion.plane(c), motion.plane(c) + motion.pixels(), [](Real v) { return std::abs(v) > 0; }))
      return true;
  return false;
}

/// Lowers weights where few pixels around agree. agreement: 0 to 1 and, in channel 1, 1 where it is known.
void trust_the_surroundings(const Image& agreement, const Trust& trust, Image& weight) {
  const Image around = gaussian_blur(agreement, agreement_sigma);
  for (std::size_t i = 0; i < weight.pixels(); ++i) {
    const auto known = static_cast<double>(around.plane(1)[i]);
    if (!(known > 0)) continue;
    const double share = static_cast<double>(around.plane(0)[i]) / known;
    weight.plane(0)[i] *= static_cast<Real>(std::clamp((share - trust.none) / (trust.full - trust.none), 0.0, 1.0));
  }
}

/// Weight of an estimate for one half, from the difference of the other half. change: surface_change.
Image weight_of(const HalfPair& pair, const Estimate& estimate, std::size_t half, const Image& change,
                const Image& shared, const Trust& trust, const TemporalParams& params) {
  const Image difference = differences(pair, estimate, 1 - half);
  Image weight = gate(difference, params), agreement(weight.width(), weight.height(), 2);
  const Image variance = gaussian_blur(sum_of_channels(pair.variance), ratio_sigma);
  const Image estimate_variance = gaussian_blur(sum_of_channels(estimate.variance), ratio_sigma);
  const Image excess = excess_error(difference);
  const Image square = square_of_radiance(pair.color[1 - half]);
  for_rows(weight.height(), [&](int y) {
    for (int x = 0; x < weight.width(); ++x) {
      const double v = variance.at(x, y, 0);
      const double expected =
          noise_of_fit * static_cast<double>(change.at(x, y, 0)) * static_cast<double>(square.at(x, y, 0));
      if (difference.at(x, y, 4) > 0 && v > 0) {
        agreement.at(x, y, 0) = weight.at(x, y, 0) * static_cast<Real>(v / (v + expected));
        agreement.at(x, y, 1) = 1;
      }
      const double error = estimate_variance.at(x, y, 0) + excess.at(x, y, 0) + expected;
      const double ratio = std::min(error > 0 ? v / error : params.max_weight, params.max_weight);
      weight.at(x, y, 0) *= static_cast<Real>(ratio * (1 - static_cast<double>(shared.at(x, y, 0))));
    }
  });
  trust_the_surroundings(agreement, trust, weight);
  return weight;
}

/// A part of the current frame.
struct Part {
  HalfPair pair;
  Geometry geometry;
  std::array<Image, surfaces> noise;
  Trust trust;
};

Image maximum(Image a, const Image& b) {
  if (!b.empty())
    for (std::size_t i = 0; i < a.pixels(); ++i) a.plane(0)[i] = std::max(a.plane(0)[i], b.plane(0)[i]);
  return a;
}

/// The sums over the neighbours, and in `shared`, empty before, whether they share their noise.
std::array<Sums, 2> join_area(const Part& part, const std::vector<Places>& places, const Rect& area,
                              const TemporalParams& params, Image& shared) {
  const HalfPair& pair = part.pair;
  const Image one(pair.width(), pair.height(), 1, 1);
  std::array<Sums, 2> sums{Sums{pair.color[0], pair.variance, one}, Sums{pair.color[1], pair.variance, one}};
  for (int k = 1; k <= params.radius; ++k) {
    const Estimate estimate = estimate_at(places, k, area);
    if (estimate.valid.empty()) break;
    // Frames that are further away share their noise too, though less of the scene stands still between them.
    shared = maximum(shared_noise(pair, estimate), shared);
    const Image change =
        surface_change(pair.width(), pair.height(), part.geometry.surface, part.noise, estimate.surface);
    for (std::size_t half = 0; half < 2; ++half)
      add_estimate(estimate, half, weight_of(pair, estimate, half, change, shared, part.trust, params), sums[half]);
  }
  return sums;
}

/// Divides the sums by their weights. Pixels without noise keep their value, which is exact.
void average(const std::array<Sums, 2>& sums, HalfPair& pair) {
  const Image variance = pair.variance;
  for_rows(pair.height(), [&](int y) {
    for (int x = 0; x < pair.width(); ++x) {
      const std::size_t i = variance.index(x, y);
      if (!is_noisy(variance, x, y)) continue;
      for (int c = 0; c < 3; ++c) pair.variance.plane(c)[i] = 0;
      for (std::size_t h = 0; h < 2; ++h) {
        const Real weight = sums[h].weight.plane(0)[i];
        for (int c = 0; c < pair.color[h].channels(); ++c)
          pair.color[h].plane(c)[i] = sums[h].color.plane(c)[i] / weight;
        for (int c = 0; c < 3; ++c)
          pair.variance.plane(c)[i] += Real(0.5) * sums[h].variance.plane(c)[i] / (weight * weight);
      }
    }
  });
}

/// Adds the sums over the noisy pixels of a band to counts, and returns their number. row: of the sums' images, where
/// the band begins.
double add_to_counts(const Image& variance, const Rect& band, int row, const std::array<Sums, 2>& sums,
                     const Image& shared, JoinCounts& counts) {
  double noisy = 0;
  for (int y = band.y0; y < band.y1; ++y)
    for (int x = 0; x < band.width(); ++x) {
      if (!is_noisy(variance, x, y)) continue;
      const int v = row + y - band.y0;
      noisy += 1;
      for (const Sums& s : sums) counts.weight += 0.5 * (static_cast<double>(s.weight.at(x, v, 0)) - 1);
      counts.shared_noise += shared.at(x, v, 0) > Real(0.5);
    }
  return noisy;
}

int halo_of(const TemporalParams& params) {
  double widest = shared_sigma;
  for (const double sigma : params.scales) widest = std::max(widest, sigma);
  return gaussian_radius(widest) + gaussian_radius(agreement_sigma);  // what agrees is averaged again
}

}  // namespace

JoinCounts join_neighbours(const Geometry& geometry, const std::array<Image, surfaces>& noise,
                           const std::vector<TimedNeighbour>& neighbours, const TemporalParams& params, HalfPair& pair,
                           Progress& progress) {
  std::vector<Places> places = follow(geometry, pair, neighbours);
  JoinCounts counts{places.size(), 0, 0};
  if (places.empty()) return counts;
  const Trust& trust = has_vectors(geometry.motion) ? with_vectors : without_vectors;
  const HalfPair before{pair.color, pair.variance, {}, pair.epsilon};
  double hidden = 0;
  for (Places& neighbour : places) hidden += hide_repeated_noise(before, neighbour);
  double noisy = 0;
  // In bands, since the estimates and their blurs take several times the memory of the frame.
  for (int y = 0; y < pair.height(); y += band_rows) {
    if (progress.cancelled()) throw Error(ExitCode::Interrupted, "interrupted");
    const Rect band{0, y, pair.width(), std::min(y + band_rows, pair.height())};
    const Rect area = intersect(grow(band, halo_of(params)), pair.variance.bounds());
    Part part{crop(before, area), crop(geometry, area), {}, trust};
    for (std::size_t s = 0; s < surfaces; ++s)
      if (!noise[s].empty()) part.noise[s] = crop(noise[s], area);
    Image shared;
    const std::array<Sums, 2> sums = join_area(part, places, area, params, shared);
    average(sums, part.pair);
    const Rect inner{0, band.y0 - area.y0, band.width(), band.y1 - area.y0};
    for (std::size_t h = 0; h < 2; ++h) paste(part.pair.color[h], inner, pair.color[h], 0, band.y0);
    paste(part.pair.variance, inner, pair.variance, 0, band.y0);
    noisy += add_to_counts(before.variance, band, inner.y0, sums, shared, counts);
    progress.advance(1);
  }
  if (noisy > 0) {
    counts.weight /= noisy;
    counts.shared_noise /= noisy;
  }
  counts.shared_noise = std::min(1.0, counts.shared_noise + hidden / static_cast<double>(places.size()));
  return counts;
}

}  // namespace polyrecon
