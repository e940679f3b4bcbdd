#include "estimate/error_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace polyrecon {
namespace {

constexpr double relative_floor = 0.01;  // of relMSE, radiance squared

Real mean_half(const Candidate& result, int x, int y, int c) {
  return Real(0.5) * (result.half[0].at(x, y, c) + result.half[1].at(x, y, c));
}

double noise_of_mean(const HalfPair& pair, const Image& variance, int x, int y, int c) {
  const double measured = variance.at(x, y, c);
  return measured >= 0 && std::isfinite(measured) ? measured : 0.5 * static_cast<double>(pair.variance.at(x, y, c));
}

double mean_of(const Image& image) {
  const double sum = ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t y) {
    double row = 0;
    for (int x = 0; x < image.width(); ++x) row += static_cast<double>(image.at(x, static_cast<int>(y), 0));
    return row;
  });
  return sum / static_cast<double>(image.pixels());
}

/// Mean over the image of (f_A - f_B)^2 / 4 and of the variance that the windows claim, both relative.
std::array<double, 2> variances(const Candidate& result) {
  const Image& claimed = result.variance;
  const auto sum = [&](const auto& term) {
    return ordered_sum(static_cast<std::size_t>(claimed.height()), [&](std::size_t row) {
      const int y = static_cast<int>(row);
      double total = 0;
      for (int c = 0; c < 3; ++c)
        for (int x = 0; x < claimed.width(); ++x) {
          const double f = mean_half(result, x, y, c);
          total += term(x, y, c) / (f * f + relative_floor);
        }
      return total;
    });
  };
  return {sum([&](int x, int y, int c) {
            const double d =
                static_cast<double>(result.half[0].at(x, y, c)) - static_cast<double>(result.half[1].at(x, y, c));
            return 0.25 * d * d;
          }),
          sum([&](int x, int y, int c) { return static_cast<double>(claimed.at(x, y, c)); })};
}

}  // namespace

double cross_validated_error(const HalfPair& pair, const Image& variance, const Candidate& result) {
  const double sum = ordered_sum(static_cast<std::size_t>(pair.height()), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    double total = 0;
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < pair.width(); ++x) {
        const double fa = result.half[0].at(x, y, c), fb = result.half[1].at(x, y, c);
        const double a = pair.color[0].at(x, y, c), b = pair.color[1].at(x, y, c), f = 0.5 * (fa + fb);
        const double known = 2 * static_cast<double>(variance.at(x, y, c)), floored = pair.variance.at(x, y, c);
        const double noise = known >= 0 && known < floored ? known : floored;
        const double error = 0.5 * ((fa - b) * (fa - b) + (fb - a) * (fb - a)) - noise - 0.25 * (fa - fb) * (fa - fb);
        total += error / (f * f + relative_floor);
      }
    return total;
  });
  return sum / (3.0 * static_cast<double>(pair.variance.pixels()));
}

ErrorMap make_error_map(const HalfPair& pair, const Image& variance, const Candidate& result) {
  ErrorMap map;
  map.mse = Image(pair.width(), pair.height(), 3);
  map.relative_mse = Image(pair.width(), pair.height(), 1);
  map.relative_variance = map.relative_noise = map.relative_mse;
  const auto [measured, claimed] = variances(result);
  if (claimed > 0) map.calibration = measured / claimed;
  constexpr double most = std::numeric_limits<Real>::max();
  for (int y = 0; y < pair.height(); ++y)
    for (int x = 0; x < pair.width(); ++x) {
      double error = 0, random = 0, noise = 0;
      for (int c = 0; c < 3; ++c) {
        const double f = mean_half(result, x, y, c), windows = result.variance.at(x, y, c);
        const double bias = std::max(static_cast<double>(result.error.at(x, y, c)) - windows, 0.0);
        map.mse.at(x, y, c) = static_cast<Real>(bias + map.calibration * windows);
        error += (bias + map.calibration * windows) / (f * f + relative_floor) / 3;
        random += map.calibration * windows / (f * f + relative_floor) / 3;
        noise += noise_of_mean(pair, variance, x, y, c) / (f * f + relative_floor) / 3;
      }
      map.relative_mse.at(x, y, 0) = static_cast<Real>(error);
      map.relative_variance.at(x, y, 0) = static_cast<Real>(random);
      map.relative_noise.at(x, y, 0) = static_cast<Real>(std::min(noise, most));
    }
  map.mean_relative_mse = mean_of(map.relative_mse);
  map.cross_validated = cross_validated_error(pair, variance, result);
  return map;
}

}  // namespace polyrecon
