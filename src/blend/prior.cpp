#include "blend/prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "blend/select.h"
#include "blend/sharpen.h"
#include "core/gaussian.h"
#include "core/halves.h"
#include "core/parallel.h"
#include "core/repair.h"

namespace polyrecon {
namespace {

constexpr double most_gain = 2;  // between the exposures of a frame and its prior; beyond it is another image
constexpr double plausible = 2;  // D / E up to which a prior is believed whole: E is known to a factor of 2.5
// Of the prior in each candidate. Where risks cannot tell, all count alike and the prior for a little over a half.
constexpr std::array<double, 6> shares{0.5, 0.6, 0.7, 0.8, 0.9, 1};
constexpr double doubt = 2;  // how far from the truth what had to be sharpened may be, in units of what that changed
constexpr double least_error = 1e-12;  // relative; keeps D / E finite
constexpr int beauty_channels = 3;

/// Factor that brings a channel of the prior to the pair's sum over the pixels where the prior is usable; 1 where that
/// is out of reach.
double exposure_gain(const Image& prior, const HalfPair& pair, int c) {
  double noisy = 0, denoised = 0;
  for (std::size_t i = 0; i < prior.pixels(); ++i) {
    if (!usable(prior.plane(c)[i])) continue;
    noisy += 0.5 * (static_cast<double>(pair.color[0].plane(c)[i]) + static_cast<double>(pair.color[1].plane(c)[i]));
    denoised += static_cast<double>(prior.plane(c)[i]);
  }
  const double gain = noisy / denoised;
  return gain >= 1 / most_gain && gain <= most_gain ? gain : 1;
}

/// D / E of the candidate that takes this share of the prior.
Image contradiction(const Image& own, const CorrectedPrior& prior, double share, const Image& mse, double epsilon,
                    double sigma) {
  Image terms(own.width(), own.height(), 2);
  for_rows(own.height(), [&](int y) {
    for (int c = 0; c < beauty_channels; ++c)
      for (int x = 0; x < own.width(); ++x) {
        const double f = own.at(x, y, c), d = static_cast<double>(prior.value.at(x, y, c)) - f;
        const double added = doubt * prior.sharpening.at(x, y, c), squares = share * share * (d * d + added * added);
        const double scale = 1 / (f * f + epsilon);
        terms.at(x, y, 0) += static_cast<Real>(std::min(squares * scale, static_cast<double>(largest_value)));
        terms.at(x, y, 1) += static_cast<Real>(
            std::min(static_cast<double>(mse.at(x, y, c)) * scale, static_cast<double>(largest_value)));
      }
  });
  terms = gaussian_blur(terms, sigma);
  Image ratio(own.width(), own.height(), 1);
  for_rows(own.height(), [&](int y) {
    for (int x = 0; x < own.width(); ++x)
      ratio.at(x, y, 0) = static_cast<Real>(static_cast<double>(terms.at(x, y, 0)) /
                                            (static_cast<double>(terms.at(x, y, 1)) + least_error));
  });
  return ratio;
}

Image belief_in(const Image& contradiction) {
  Image belief(contradiction.width(), contradiction.height(), 1);
  for_rows(belief.height(), [&](int y) {
    for (int x = 0; x < belief.width(); ++x)
      belief.at(x, y, 0) =
          static_cast<Real>(std::exp(-std::max(0.0, static_cast<double>(contradiction.at(x, y, 0)) - plausible)));
  });
  return belief;
}

/// own with the given share of the prior in its beauty, as far as that is believed.
Image toward(Image own, const Image& prior, Real share, const Image& belief) {
  for_rows(own.height(), [&](int y) {
    for (int c = 0; c < beauty_channels; ++c)
      for (int x = 0; x < own.width(); ++x)
        own.at(x, y, c) += share * belief.at(x, y, 0) * (prior.at(x, y, c) - own.at(x, y, c));
  });
  return own;
}

}  // namespace

CorrectedPrior correct_prior(Pass prior, const HalfPair& pair, const Image& own) {
  Image out = prior.has_halves() ? mean_of_halves({std::move(prior.half_a), std::move(prior.half_b)}, beauty_channels)
                                 : std::move(prior.mean);
  for (int c = 0; c < beauty_channels; ++c) {
    const auto gain = static_cast<Real>(exposure_gain(out, pair, c));
    for (std::size_t i = 0; i < out.pixels(); ++i) {
      const Real value = out.plane(c)[i];
      out.plane(c)[i] = usable(value) ? gain * value : own.plane(c)[i];
    }
  }
  Image sharp = sharpen_to(out, own, pair.epsilon);
  for (int c = 0; c < beauty_channels; ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i) out.plane(c)[i] = sharp.plane(c)[i] - out.plane(c)[i];
  return {std::move(sharp), std::move(out)};
}

double noise_in_prior(const Image& prior, const HalfPair& pair, const Image& own) {
  double shared = 0, input = 0;
  for (int c = 0; c < beauty_channels; ++c)
    for (std::size_t i = 0; i < own.pixels(); ++i) {
      const double f = own.plane(c)[i], p = prior.plane(c)[i];
      const double noisy =
          0.5 * (static_cast<double>(pair.color[0].plane(c)[i]) + static_cast<double>(pair.color[1].plane(c)[i]));
      // By the brightest: an outlier that was taken out of the input, and is still in the prior, would decide alone.
      const double scale = 1 / (std::max({f * f, p * p, noisy * noisy}) + pair.epsilon);
      shared += (p - f) * (noisy - f) * scale;
      input += (noisy - f) * (noisy - f) * scale;
    }
  return input > 0 ? shared / input : 0;
}

Candidate add_prior(const HalfPair& pair, const CorrectedPrior& prior, const Image& mse, Candidate own,
                    const SelectParams& params, std::size_t max_bytes) {
  const auto make = [&](const std::array<Image, 2>& beauty, const Rect& region) {
    const CorrectedPrior part{crop(prior.value, region), crop(prior.sharpening, region)};
    const Image mean = mean_of_halves(beauty, beauty_channels), error = crop(mse, region);
    std::vector<std::array<Image, 2>> corrected(shares.size());
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const Image belief = belief_in(contradiction(mean, part, shares[k], error, pair.epsilon, params.risk_sigma));
      for (std::size_t h = 0; h < 2; ++h)
        corrected[k][h] = toward(beauty[h], part.value, static_cast<Real>(shares[k]), belief);
    }
    return corrected;
  };
  const auto beauty_of = [](const Image& half) { return crop(half, half.bounds(), 0, beauty_channels); };
  const std::array<Image, 2> best =
      select_correction(pair, {beauty_of(own.half[0]), beauty_of(own.half[1])},
                        {shares.size(), gaussian_reach(params.risk_sigma), make}, params, max_bytes);
  for (std::size_t h = 0; h < 2; ++h)
    for (int c = 0; c < beauty_channels; ++c) std::copy_n(best[h].plane(c), best[h].pixels(), own.half[h].plane(c));
  return own;
}

}  // namespace polyrecon
