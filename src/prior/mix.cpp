#include "prior/mix.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/color_layout.h"
#include "core/gaussian.h"
#include "core/halves.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/pi.h"
#include "core/real.h"
#include "core/spectrum_corner.h"

namespace polyrecon {
namespace {

constexpr std::array<double, 3> share_sigmas{6, 12, 24};  // pixels
constexpr double noise_sigma = 2;                         // pixels
constexpr double kept_noise_sigma = 6;                    // pixels
constexpr double share_without_validation = 0.25;
constexpr double most_factor = 4, least_magnitude = 1e-12;
constexpr double mean_noise_part = 0.1, least_noise = 0.003;

/// Sum of a channel over the image.
double sum_of(const Image& image, int c) {
  return ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t y) {
    double row = 0;
    for (int x = 0; x < image.width(); ++x) row += static_cast<double>(image.at(x, static_cast<int>(y), c));
    return row;
  });
}

/// v: (y - p)^2 relative to the brightness of p, averaged.
Image relative_noise(const Image& y, const Image& p, double epsilon, const Image& sampled) {
  Image v(p.width(), p.height(), 1);
  for_rows(v.height(), [&](int row) {
    for (int x = 0; x < v.width(); ++x) {
      double sum = 0;
      for (int c = 0; c < ColorLayout::primaries; ++c) {
        const double value = p.at(x, row, c), d = static_cast<double>(y.at(x, row, c)) - value;
        sum += d * d / (value * value + epsilon) / ColorLayout::primaries;
      }
      v.at(x, row, 0) = storable(sum);
    }
  });
  return gaussian_blur(v, noise_sigma, sampled);
}

/// 1 / (p^2 + epsilon) / (v + floor): the weight s of a pixel's terms.
Image term_weights(const Image& y, const Image& p, double epsilon, const Image& sampled) {
  const Image v = relative_noise(y, p, epsilon, sampled);
  const double floor = mean_noise_part * sum_of(v, 0) / static_cast<double>(v.pixels()) + least_noise;
  Image weights(p.width(), p.height(), ColorLayout::primaries);
  for_rows(p.height(), [&](int row) {
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < p.width(); ++x) {
        const double value = p.at(x, row, c), noise = v.at(x, row, 0);
        weights.at(x, row, c) =
            in_mask(sampled, p.index(x, row)) ? storable(1 / (value * value + epsilon) / (noise + floor)) : Real(0);
      }
  });
  return weights;
}

/// Channels of the terms of w and of the fair w' (mix.h): sums of these are Gaussian means.
enum Term : std::uint8_t { Numerator, Denominator, FairNumerator, FairDenominator, FairSquare, TermCount };

/// Means of the terms, one for each.
using TermMeans = std::array<double, TermCount>;

/// Adds the terms of one half, before they are averaged. y: the samples of the other half; own: those of this one.
void add_terms(const Image& y, const Image& own, const Image& p, const Image& d, double epsilon, const Image& sampled,
               Image& terms) {
  const Image s = term_weights(y, p, epsilon, sampled), fair_s = term_weights(own, d, epsilon, sampled);
  for_rows(terms.height(), [&](int row) {
    for (int x = 0; x < terms.width(); ++x) {
      double fair = 0;
      for (int c = 0; c < ColorLayout::primaries; ++c) {
        const double prior = p.at(x, row, c), ours = d.at(x, row, c), step = ours - prior;
        const double error = static_cast<double>(y.at(x, row, c)) - prior;
        const double weighted = step * static_cast<double>(s.at(x, row, c));
        // Where the prior is bright, squares are relative to it.
        const double relative = (ours * ours + epsilon) / (prior * prior + ours * ours + epsilon);
        const double fairly = step * relative * static_cast<double>(fair_s.at(x, row, c));
        terms.at(x, row, Numerator) += storable(error * weighted);
        terms.at(x, row, Denominator) += storable(step * weighted);
        terms.at(x, row, FairDenominator) += storable(step * fairly);
        fair += error * fairly;
      }
      terms.at(x, row, FairNumerator) += storable(fair);
      terms.at(x, row, FairSquare) += storable(fair * fair);
    }
  });
}

/// w, drawn towards w' as far as w' contradicts it. pixels: how many independent ones the means are of.
double corrected_share(double w, const TermMeans& means, double pixels) {
  if (!(means[FairDenominator] > 0)) return w;
  const double fair = means[FairNumerator] / means[FairDenominator];
  const double variance = std::max(0.0, means[FairSquare] - means[FairNumerator] * means[FairNumerator]) / pixels;
  const double contradiction = std::abs(fair - w) - std::sqrt(variance) / means[FairDenominator];
  return contradiction > 0 ? w + std::copysign(contradiction, fair - w) : w;
}

Image difference(const Image& a, const Image& b) {
  Image out(a.width(), a.height(), ColorLayout::primaries);
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < out.width(); ++x) out.at(x, y, c) = a.at(x, y, c) - b.at(x, y, c);
  });
  return out;
}

/// k of unvalidated_share at a pixel; the image continues with the values of its border.
double corner_at(const Image& image, int x, int y, int c) {
  return corner_of_spectrum([&](int i, int j) {
    return static_cast<double>(
        image.at(std::clamp(x + i, 0, image.width() - 1), std::clamp(y + j, 0, image.height() - 1), c));
  });
}

}  // namespace

Image reconstruction_share(const HalfPair& pair, const ValidationHalves& halves) {
  Image terms(pair.width(), pair.height(), TermCount);
  for (std::size_t h = 0; h < 2; ++h)
    add_terms(pair.color[1 - h], pair.color[h], halves.prior[h], halves.ours[h], pair.epsilon, pair.sampled, terms);
  const auto pixels = static_cast<double>(terms.pixels());
  TermMeans means{};
  for (std::size_t t = 0; t < TermCount; ++t) means[t] = sum_of(terms, static_cast<int>(t)) / pixels;
  Image share(pair.width(), pair.height(), 1, Real(1));
  const double weight = means[Denominator];
  if (!(weight > 0)) return share;  // both pictures are the same
  const double everywhere = std::clamp(corrected_share(means[Numerator] / weight, means, pixels), 0.0, 1.0);
  share = Image(pair.width(), pair.height(), 1);
  for (const double sigma : share_sigmas) {
    const Image around = gaussian_blur(terms, sigma, pair.sampled);
    const double independent = std::min(4 * pi * sigma * sigma, pixels);  // 1 / sum of the squared weights
    for_rows(share.height(), [&](int y) {
      for (int x = 0; x < share.width(); ++x) {
        TermMeans here{};
        for (std::size_t t = 0; t < TermCount; ++t) here[t] = static_cast<double>(around.at(x, y, static_cast<int>(t)));
        const double w = (here[Numerator] + weight * everywhere) / (here[Denominator] + weight);
        share.at(x, y, 0) += static_cast<Real>(corrected_share(w, here, independent) / share_sigmas.size());
      }
    });
  }
  for_rows(share.height(), [&](int y) {
    for (int x = 0; x < share.width(); ++x) share.at(x, y, 0) = std::clamp(share.at(x, y, 0), Real(0), Real(1));
  });
  return share;
}

Image unvalidated_share(const HalfPair& pair, const Image& prior, const Image& reconstruction) {
  const Image noisy = mean_of_halves(pair.color, ColorLayout::primaries);
  const Image s = term_weights(noisy, prior, pair.epsilon, pair.sampled);
  const Image taken = difference(noisy, prior), kept = difference(reconstruction, prior);
  Image terms(pair.width(), pair.height(), 2);
  for_rows(terms.height(), [&](int y) {
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < terms.width(); ++x) {
        const double of_noise = corner_at(taken, x, y, c), weight = s.at(x, y, c);
        terms.at(x, y, 0) += storable(of_noise * corner_at(kept, x, y, c) * weight);
        terms.at(x, y, 1) += storable(of_noise * of_noise * weight);
      }
  });
  terms = gaussian_blur(terms, kept_noise_sigma, pair.sampled);
  Image share(pair.width(), pair.height(), 1);
  for_rows(share.height(), [&](int y) {
    for (int x = 0; x < share.width(); ++x) {
      const double noise = terms.at(x, y, 1);
      const double b = noise > 0 ? std::clamp(static_cast<double>(terms.at(x, y, 0)) / noise, 0.0, 1.0) : 0;
      share.at(x, y, 0) = static_cast<Real>(share_without_validation * (1 - b));
    }
  });
  return share;
}

Candidate mix_with_prior(Candidate reconstruction, const Image& prior, const Image& share) {
  for (Image& half : reconstruction.half)
    for_rows(prior.height(), [&](int y) {
      for (int c = 0; c < ColorLayout::primaries; ++c)
        for (int x = 0; x < prior.width(); ++x)
          half.at(x, y, c) = prior.at(x, y, c) + share.at(x, y, 0) * (half.at(x, y, c) - prior.at(x, y, c));
    });
  return reconstruction;
}

Image follow_beauty(Image layers, const Image& beauty) {
  const int aovs = ColorLayout(layers.channels()).layers() - 1;
  for_rows(layers.height(), [&](int y) {
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < layers.width(); ++x) {
        const double before = layers.at(x, y, c), after = beauty.at(x, y, c);
        const double factor = before > 0 ? std::clamp(after / before, 1 / most_factor, most_factor) : 1;
        double sum = 0, magnitudes = 0;
        for (int layer = 1; layer <= aovs; ++layer) {
          const double value = layers.at(x, y, ColorLayout::channel(layer, c));
          sum += value;
          magnitudes += std::abs(value);
        }
        magnitudes += std::abs(before - sum) + least_magnitude;  // what no layer holds takes its part
        const double left = after - factor * before;
        for (int layer = 1; layer <= aovs; ++layer) {
          Real& value = layers.at(x, y, ColorLayout::channel(layer, c));
          const double share = (std::abs(static_cast<double>(value)) + least_magnitude / aovs) / magnitudes;
          value = static_cast<Real>(factor * static_cast<double>(value) + left * share);
        }
        layers.at(x, y, c) = beauty.at(x, y, c);
      }
  });
  return layers;
}

}  // namespace polyrecon
