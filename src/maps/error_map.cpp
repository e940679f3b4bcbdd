#include "maps/error_map.h"

#include <algorithm>
#include <cmath>

#include "blend/select.h"
#include "core/gaussian.h"
#include "core/halves.h"
#include "core/mask.h"
#include "core/mean.h"
#include "core/parallel.h"
#include "core/real.h"
#include "core/relmse.h"

namespace polyrecon {
namespace {

constexpr double smoothing_sigma = 2;  // pixels
constexpr double certain_gain = 0.5, least_error_left = 0.25;

/// The terms of the error of one channel, relative to energy.
struct ChannelErrors {
  Image energy;    ///< relmse_denominator(yhat).
  Image variance;  ///< (f_A - f_B)^2 / 4, averaged.
  Image noise;     ///< Noise variance of the input's mean, not averaged.
  Image bound;     ///< The same, averaged.
};

double noise_of_mean(const HalfPair& pair, const Image& variance, int x, int y, int c) {
  if (!in_mask(pair.sampled, variance.index(x, y))) return 0;
  const double measured = variance.at(x, y, c);
  return measured >= 0 && std::isfinite(measured) ? measured : 0.5 * static_cast<double>(pair.variance.at(x, y, c));
}

ChannelErrors errors_of_channel(const HalfPair& pair, const Image& variance, const Candidate& result, int c) {
  const auto image = [&] { return Image(pair.width(), pair.height(), 1); };
  ChannelErrors out{image(), image(), image(), {}};
  for_rows(pair.height(), [&](int y) {
    for (int x = 0; x < pair.width(); ++x) {
      const double a = result.half[0].at(x, y, c), b = result.half[1].at(x, y, c), f = 0.5 * (a + b);
      const double energy = relmse_denominator(f);
      out.energy.at(x, y, 0) = storable(energy);
      out.variance.at(x, y, 0) = storable(variance_of_mean(a, b) / energy);
      out.noise.at(x, y, 0) = storable(noise_of_mean(pair, variance, x, y, c) / energy);
    }
  });
  out.variance = gaussian_blur(out.variance, smoothing_sigma, pair.sampled);
  out.bound = gaussian_blur(out.noise, smoothing_sigma, pair.sampled);
  return out;
}

}  // namespace

ErrorMap make_error_map(const HalfPair& pair, const Image& variance, const Candidate& result, const Image& rendered) {
  ErrorMap map;
  map.mse = Image(pair.width(), pair.height(), 3);
  map.relative_mse = Image(pair.width(), pair.height(), 1);
  map.relative_variance = map.relative_noise = map.relative_mse;
  for (int c = 0; c < 3; ++c) {
    const ChannelErrors channel = errors_of_channel(pair, variance, result, c);
    for_rows(pair.height(), [&](int y) {
      for (int x = 0; x < pair.width(); ++x) {
        if (!in_mask(rendered, map.mse.index(x, y))) continue;
        const double energy = channel.energy.at(x, y, 0), random = channel.variance.at(x, y, 0);
        const double squared_bias = static_cast<double>(result.squared_bias.at(x, y, c)) / energy;
        const double error = std::min(squared_bias + random, static_cast<double>(channel.bound.at(x, y, 0)));
        map.mse.at(x, y, c) = storable(error * energy);
        map.relative_mse.at(x, y, 0) += static_cast<Real>(error / 3);
        map.relative_variance.at(x, y, 0) += static_cast<Real>(std::min(random, error) / 3);
        map.relative_noise.at(x, y, 0) += channel.noise.at(x, y, 0) / 3;
      }
    });
  }
  map.mean_relative_mse = mean_of(map.relative_mse);
  return map;
}

void lower_error(const Image& reconstruction, const Image& prior, const Image& share, const Image& sampled,
                 ErrorMap& error) {
  Image gain(prior.width(), prior.height(), 3);
  for_rows(gain.height(), [&](int y) {
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < gain.width(); ++x) {
        const double part = 1 - static_cast<double>(share.at(x, y, 0));
        const double d =
            part * (static_cast<double>(reconstruction.at(x, y, c)) - static_cast<double>(prior.at(x, y, c)));
        gain.at(x, y, c) = storable(certain_gain * d * d);
      }
  });
  gain = gaussian_blur(gain, smoothing_sigma, sampled);
  error.prior_share = Image(prior.width(), prior.height(), 1);
  for_rows(gain.height(), [&](int y) {
    for (int x = 0; x < gain.width(); ++x) {
      double relative = 0;
      for (int c = 0; c < 3; ++c) {
        const double f = reconstruction.at(x, y, c), p = prior.at(x, y, c), w = share.at(x, y, 0);
        const double before = error.mse.at(x, y, c);
        const double after = std::max(before - static_cast<double>(gain.at(x, y, c)), least_error_left * before);
        error.mse.at(x, y, c) = storable(after);
        relative += after / relmse_denominator(p + w * (f - p)) / 3;
      }
      error.relative_mse.at(x, y, 0) = storable(relative);
      error.prior_share.at(x, y, 0) = 1 - share.at(x, y, 0);
      error.relative_variance.at(x, y, 0) =
          std::min(error.relative_variance.at(x, y, 0), error.relative_mse.at(x, y, 0));
    }
  });
  error.mean_relative_mse = mean_of(error.relative_mse);
}

}  // namespace polyrecon
