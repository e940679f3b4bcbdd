#include "estimate/error_map.h"

#include <algorithm>

#include "core/parallel.h"

namespace polyrecon {
namespace {

constexpr double relative_floor = 0.01;  // of relMSE, radiance squared

Real mean_half(const Candidate& result, int x, int y, int c) {
  return Real(0.5) * (result.half[0].at(x, y, c) + result.half[1].at(x, y, c));
}

double mean_of(const Image& image) {
  const double sum = ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t y) {
    double row = 0;
    for (int x = 0; x < image.width(); ++x) row += static_cast<double>(image.at(x, static_cast<int>(y), 0));
    return row;
  });
  return sum / static_cast<double>(image.pixels());
}

void scale(Image& image, double factor) {
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      image.plane(c)[i] = static_cast<Real>(factor * static_cast<double>(image.plane(c)[i]));
}

}  // namespace

double cross_validated_error(const HalfPair& pair, const Candidate& result) {
  const double sum = ordered_sum(static_cast<std::size_t>(pair.height()), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    double total = 0;
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < pair.width(); ++x) {
        const double fa = result.half[0].at(x, y, c), fb = result.half[1].at(x, y, c);
        const double a = pair.color[0].at(x, y, c), b = pair.color[1].at(x, y, c), f = 0.5 * (fa + fb);
        const double error = 0.5 * ((fa - b) * (fa - b) + (fb - a) * (fb - a)) - static_cast<double>(pair.variance.at(x, y, c)) -
                             0.25 * (fa - fb) * (fa - fb);
        total += error / (f * f + relative_floor);
      }
    return total;
  });
  return sum / (3.0 * static_cast<double>(pair.variance.pixels()));
}

ErrorMap make_error_map(const HalfPair& pair, const Candidate& result) {
  ErrorMap map;
  map.mse = result.error;
  map.relative_mse = Image(pair.width(), pair.height(), 1);
  map.relative_variance = map.relative_mse;
  for (int y = 0; y < pair.height(); ++y)
    for (int x = 0; x < pair.width(); ++x) {
      double error = 0, variance = 0;
      for (int c = 0; c < 3; ++c) {
        const auto f = static_cast<double>(mean_half(result, x, y, c));
        error += static_cast<double>(result.error.at(x, y, c)) / (f * f + relative_floor) / 3;
        variance += static_cast<double>(result.variance.at(x, y, c)) / (f * f + relative_floor) / 3;
      }
      map.relative_mse.at(x, y, 0) = static_cast<Real>(error);
      map.relative_variance.at(x, y, 0) = static_cast<Real>(std::min(variance, error));
    }
  const double modelled = mean_of(map.relative_mse);
  map.cross_validated = cross_validated_error(pair, result);
  const double ratio = modelled > 0 ? map.cross_validated / modelled : 1;
  if (ratio >= 1.0 / 16 && ratio <= 16) map.calibration = ratio;
  for (Image* image : {&map.mse, &map.relative_mse, &map.relative_variance}) scale(*image, map.calibration);
  return map;
}

}  // namespace polyrecon
