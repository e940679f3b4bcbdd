#include "prior/prior_candidate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "blend/select.h"
#include "core/color_layout.h"
#include "core/gaussian.h"
#include "core/halves.h"
#include "core/parallel.h"
#include "core/repair.h"
#include "prior/exposure.h"
#include "prior/sharpen.h"

namespace polyrecon {
namespace {

// D / E up to which a prior is fully trusted. E is known to a factor of 2.5 (TakesTheNoiseOutOfASceneOfKnownTruth in
// tests/pipeline/reconstruct_test.cpp).
constexpr double plausible = 2;
// Share s of the prior in each candidate. Where their risks are equal, all candidates count alike, and the prior's
// share in the result is a little over a half.
constexpr std::array<double, 6> shares{0.5, 0.6, 0.7, 0.8, 0.9, 1};
constexpr double doubt = 2;            // error of the sharpening, relative to what it changed
constexpr double least_error = 1e-12;  // relative; keeps D / E finite

/// D / E of the candidate with this share of the prior.
Image contradiction(const Image& reconstruction, const CorrectedPrior& prior, double share, const Image& mse,
                    double epsilon, double sigma) {
  Image terms(reconstruction.width(), reconstruction.height(), 2);
  for_rows(terms.height(), [&](int y) {
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < terms.width(); ++x) {
        const double f = reconstruction.at(x, y, c), d = static_cast<double>(prior.value.at(x, y, c)) - f;
        const double added = doubt * prior.sharpening.at(x, y, c), squares = share * share * (d * d + added * added);
        const double scale = 1 / (f * f + epsilon);
        terms.at(x, y, 0) += static_cast<Real>(std::min(squares * scale, static_cast<double>(largest_value)));
        terms.at(x, y, 1) += static_cast<Real>(
            std::min(static_cast<double>(mse.at(x, y, c)) * scale, static_cast<double>(largest_value)));
      }
  });
  terms = gaussian_blur(terms, sigma);
  Image ratio(terms.width(), terms.height(), 1);
  for_rows(ratio.height(), [&](int y) {
    for (int x = 0; x < ratio.width(); ++x)
      ratio.at(x, y, 0) = static_cast<Real>(static_cast<double>(terms.at(x, y, 0)) /
                                            (static_cast<double>(terms.at(x, y, 1)) + least_error));
  });
  return ratio;
}

/// The trust b in the prior, from D / E.
Image trust_in_prior(const Image& contradiction) {
  Image trust(contradiction.width(), contradiction.height(), 1);
  for_rows(trust.height(), [&](int y) {
    for (int x = 0; x < trust.width(); ++x)
      trust.at(x, y, 0) =
          static_cast<Real>(std::exp(-std::max(0.0, static_cast<double>(contradiction.at(x, y, 0)) - plausible)));
  });
  return trust;
}

/// f + share x trust x (prior - f) for the beauty f.
Image toward(Image f, const Image& prior, Real share, const Image& trust) {
  for_rows(f.height(), [&](int y) {
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < f.width(); ++x)
        f.at(x, y, c) += share * trust.at(x, y, 0) * (prior.at(x, y, c) - f.at(x, y, c));
  });
  return f;
}

}  // namespace

CorrectedPrior correct_prior(Pass prior, const HalfPair& pair, const Image& reconstruction) {
  Image out = prior.has_halves()
                  ? mean_of_halves({std::move(prior.half_a), std::move(prior.half_b)}, ColorLayout::primaries)
                  : std::move(prior.mean);
  out = in_exposure(std::move(out), pair, reconstruction);
  Image sharp = sharpen_to(out, reconstruction, pair.epsilon);
  for (int c = 0; c < ColorLayout::primaries; ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i) out.plane(c)[i] = sharp.plane(c)[i] - out.plane(c)[i];
  return {std::move(sharp), std::move(out)};
}

double noise_in_prior(const Image& prior, const HalfPair& pair, const Image& reconstruction) {
  double shared = 0, input = 0;
  for (int c = 0; c < ColorLayout::primaries; ++c)
    for (std::size_t i = 0; i < prior.pixels(); ++i) {
      const double f = reconstruction.plane(c)[i], p = prior.plane(c)[i];
      const double noisy =
          0.5 * (static_cast<double>(pair.color[0].plane(c)[i]) + static_cast<double>(pair.color[1].plane(c)[i]));
      // Relative to the brightest, or a firefly that was removed from the input and is still in the prior would
      // dominate.
      const double scale = 1 / (std::max({f * f, p * p, noisy * noisy}) + pair.epsilon);
      shared += (p - f) * (noisy - f) * scale;
      input += (noisy - f) * (noisy - f) * scale;
    }
  return input > 0 ? shared / input : 0;
}

Candidate add_prior(const HalfPair& pair, const CorrectedPrior& prior, const Image& mse, Candidate result,
                    const SelectParams& params, std::size_t max_bytes) {
  const auto make = [&](const std::array<Image, 2>& beauty, const Rect& region) {
    const CorrectedPrior part{crop(prior.value, region), crop(prior.sharpening, region)};
    const Image mean = mean_of_halves(beauty, ColorLayout::primaries), error = crop(mse, region);
    std::vector<std::array<Image, 2>> corrected(shares.size());
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const Image trust = trust_in_prior(contradiction(mean, part, shares[k], error, pair.epsilon, params.risk_sigma));
      for (std::size_t h = 0; h < 2; ++h)
        corrected[k][h] = toward(beauty[h], part.value, static_cast<Real>(shares[k]), trust);
    }
    return corrected;
  };
  const auto beauty_of = [](const Image& half) { return crop(half, half.bounds(), 0, ColorLayout::primaries); };
  const std::array<Image, 2> best =
      select_correction(pair, {beauty_of(result.half[0]), beauty_of(result.half[1])},
                        {shares.size(), gaussian_radius(params.risk_sigma), make}, params, max_bytes);
  for (std::size_t h = 0; h < 2; ++h)
    for (int c = 0; c < ColorLayout::primaries; ++c)
      std::copy_n(best[h].plane(c), best[h].pixels(), result.half[h].plane(c));
  return result;
}

}  // namespace polyrecon
