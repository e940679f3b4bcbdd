#include "temporal/join.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/gaussian.h"
#include "core/parallel.h"
#include "core/picture_mask.h"
#include "core/rect.h"
#include "polyrecon/error.h"
#include "temporal/follow.h"
#include "temporal/neighbour.h"

namespace polyrecon {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double ratio_sigma = 2;   // pixels; variances are averaged before they are compared, as single ones are noisy
constexpr double shared_sigma = 8;  // pixels; squared differences are averaged to find whether frames share their noise
// Frames share their noise where squared differences are below this part of what independent noise makes.
constexpr double shared_below = 0.7;
constexpr double tiny = 1e-30;
constexpr int band_rows = 256;  // height of a band of the frame

/// An estimate of the current frame from other frames; zero where it is not valid.
struct Estimate {
  std::array<Image, 2> color;
  Image variance;                    ///< Of one half, 3 channels.
  std::vector<unsigned char> valid;  ///< One byte per pixel.
};

/// Whether a pixel is seen in the neighbour and holds a picture there.
unsigned char sees_picture(const Places& places, int x, int y) {
  const Image& picture = places.frame->pair.sampled;
  const unsigned char seen = places.seen[places.position.index(x, y)];
  if (!seen || picture.empty()) return seen;
  const auto nearest = [](Real position, int size) {
    return std::clamp(static_cast<int>(std::lround(position)), 0, size - 1);
  };
  return in_picture(picture, picture.index(nearest(places.position.at(x, y, 0), picture.width()),
                                           nearest(places.position.at(x, y, 1), picture.height())));
}

Estimate estimate_from(const Places& places, const Rect& area) {
  const HalfPair& pair = places.frame->pair;
  Estimate out{{sample_at(pair.color[0], places, area, true), sample_at(pair.color[1], places, area, true)},
               sample_at(pair.variance, places, area, false),
               {}};
  for (int y = area.y0; y < area.y1; ++y)
    for (int x = area.x0; x < area.x1; ++x) out.valid.push_back(sees_picture(places, x, y));
  return out;
}

/// The mean of two estimates where both are valid, else the valid one.
Estimate combine(Estimate a, const Estimate& b) {
  for_rows(a.variance.height(), [&](int y) {
    for (int x = 0; x < a.variance.width(); ++x) {
      const std::size_t i = a.variance.index(x, y);
      if (!b.valid[i]) continue;
      const Real share = a.valid[i] ? Real(0.5) : Real(1);
      for (std::size_t h = 0; h < 2; ++h)
        for (int c = 0; c < a.color[h].channels(); ++c)
          a.color[h].plane(c)[i] = share * (a.color[h].plane(c)[i] + b.color[h].plane(c)[i]);
      for (int c = 0; c < 3; ++c)
        a.variance.plane(c)[i] = share * share * (a.variance.plane(c)[i] + b.variance.plane(c)[i]);
      a.valid[i] = 1;
    }
  });
  return a;
}

/// The estimate from the frames k before and k after; empty if there are none.
Estimate estimate_at(const std::vector<Places>& all, int k, const Rect& area) {
  Estimate out;
  for (const Places& places : all)
    if (std::abs(places.offset) == k)
      out = out.valid.empty() ? estimate_from(places, area) : combine(std::move(out), estimate_from(places, area));
  return out;
}

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
        const double change = squared(d, i) / std::max(kept * noise, tiny);
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

/// The part of the noise that the estimate shares with the current frame, 0 to 1, 1 channel. The squared difference of
/// independent noise is the sum of the variances; that of shared noise is 0.
Image shared_noise(const Image& difference) {
  Image moments(difference.width(), difference.height(), 2);
  for (std::size_t i = 0; i < moments.pixels(); ++i) {
    moments.plane(0)[i] = static_cast<Real>(squared(difference, i));
    moments.plane(1)[i] = difference.plane(3)[i];
  }
  moments = gaussian_blur(moments, shared_sigma);
  Image out(moments.width(), moments.height(), 1);
  for (std::size_t i = 0; i < out.pixels(); ++i) {
    const double noise = moments.plane(1)[i], ratio = noise > 0 ? static_cast<double>(moments.plane(0)[i]) / noise : 1;
    out.plane(0)[i] = static_cast<Real>(std::max(0.0, 1 - ratio / shared_below));
  }
  return out;
}

/// Running sums of one half over the pixel itself (with w = 1) and the estimates.
struct Sums {
  Image color, variance, shared, weight;  ///< sum w y, sum w^2 Var, sum w shared (estimates only), sum w
};

void add_estimate(const Estimate& estimate, std::size_t half, const Image& weight, const Image& shared, Sums& sums) {
  for_rows(weight.height(), [&](int y) {
    for (int x = 0; x < weight.width(); ++x) {
      const std::size_t i = weight.index(x, y);
      const Real w = weight.plane(0)[i];
      if (w == 0) continue;
      for (int c = 0; c < sums.color.channels(); ++c) sums.color.plane(c)[i] += w * estimate.color[half].plane(c)[i];
      for (int c = 0; c < 3; ++c) sums.variance.plane(c)[i] += w * w * estimate.variance.plane(c)[i];
      sums.shared.plane(0)[i] += w * shared.plane(0)[i];
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

/// Weight of an estimate for one half, from the difference of the other half.
Image weight_of(const HalfPair& pair, const Estimate& estimate, const Image& difference, const TemporalParams& params) {
  Image weight = gate(difference, params);
  const Image variance = gaussian_blur(sum_of_channels(pair.variance), ratio_sigma);
  const Image estimate_variance = gaussian_blur(sum_of_channels(estimate.variance), ratio_sigma);
  const Image excess = excess_error(difference);
  for_rows(weight.height(), [&](int y) {
    for (int x = 0; x < weight.width(); ++x) {
      const double error = estimate_variance.at(x, y, 0) + excess.at(x, y, 0), v = variance.at(x, y, 0);
      weight.at(x, y, 0) *= static_cast<Real>(std::min(error > 0 ? v / error : params.max_weight, params.max_weight));
    }
  });
  return weight;
}

std::array<Sums, 2> join_area(const HalfPair& pair, const std::vector<Places>& places, const Rect& area,
                              const TemporalParams& params) {
  const Image none(pair.width(), pair.height(), 1), one(pair.width(), pair.height(), 1, 1);
  std::array<Sums, 2> sums{Sums{pair.color[0], pair.variance, none, one},
                           Sums{pair.color[1], pair.variance, none, one}};
  for (int k = 1; k <= params.radius; ++k) {
    const Estimate estimate = estimate_at(places, k, area);
    if (estimate.valid.empty()) break;
    for (std::size_t half = 0; half < 2; ++half) {
      const Image difference = differences(pair, estimate, 1 - half);
      add_estimate(estimate, half, weight_of(pair, estimate, difference, params), shared_noise(difference), sums[half]);
    }
  }
  return sums;
}

/// Divides the sums by their weights. Pixels without noise keep their value, which is exact.
void average(const std::array<Sums, 2>& sums, HalfPair& pair) {
  const Image variance = pair.variance;
  for_rows(pair.height(), [&](int y) {
    for (int x = 0; x < pair.width(); ++x) {
      const std::size_t i = variance.index(x, y);
      if (!(variance.plane(0)[i] > 0 || variance.plane(1)[i] > 0 || variance.plane(2)[i] > 0)) continue;
      for (int c = 0; c < 3; ++c) pair.variance.plane(c)[i] = 0;
      for (std::size_t h = 0; h < 2; ++h) {
        const Real weight = sums[h].weight.plane(0)[i], others = weight - 1;
        for (int c = 0; c < pair.color[h].channels(); ++c)
          pair.color[h].plane(c)[i] = sums[h].color.plane(c)[i] / weight;
        const Real shared = others > 0 ? sums[h].shared.plane(0)[i] / others : Real(0);
        for (int c = 0; c < 3; ++c)
          pair.variance.plane(c)[i] += Real(0.5) * (shared * variance.plane(c)[i] +
                                                    (1 - shared) * sums[h].variance.plane(c)[i] / (weight * weight));
      }
    }
  });
}

int halo_of(const TemporalParams& params) {
  double widest = shared_sigma;
  for (const double sigma : params.scales) widest = std::max(widest, sigma);
  return gaussian_radius(widest);
}

}  // namespace

JoinCounts join_neighbours(const Image& motion, const std::vector<TimedNeighbour>& neighbours,
                           const TemporalParams& params, HalfPair& pair, Progress& progress) {
  const std::vector<Places> places = follow(motion, pair, neighbours);
  JoinCounts counts{places.size(), 0};
  if (places.empty()) return counts;
  const HalfPair before{pair.color, pair.variance, {}, pair.epsilon};
  // In bands, since the estimates and their blurs take several times the memory of the frame.
  for (int y = 0; y < pair.height(); y += band_rows) {
    if (progress.cancelled()) throw Error(ExitCode::Interrupted, "interrupted");
    const Rect band{0, y, pair.width(), std::min(y + band_rows, pair.height())};
    const Rect area = intersect(grow(band, halo_of(params)), pair.variance.bounds());
    HalfPair part = crop(before, area);
    const std::array<Sums, 2> sums = join_area(part, places, area, params);
    average(sums, part);
    const Rect inner{0, band.y0 - area.y0, band.width(), band.y1 - area.y0};
    for (std::size_t h = 0; h < 2; ++h) paste(part.color[h], inner, pair.color[h], 0, band.y0);
    paste(part.variance, inner, pair.variance, 0, band.y0);
    for (int v = inner.y0; v < inner.y1; ++v)
      for (int x = 0; x < band.width(); ++x)
        for (const Sums& s : sums) counts.weight += 0.5 * (static_cast<double>(s.weight.at(x, v, 0)) - 1);
    progress.advance(1);
  }
  counts.weight /= static_cast<double>(pair.variance.pixels());
  return counts;
}

}  // namespace polyrecon
