#include "metrics/flicker.h"

#include <cmath>
#include <cstddef>

#include "core/relmse.h"

namespace polyrecon {
namespace {

struct RelativeError {
  double value = 0, reference_noise = 0;
};

RelativeError relative_error_at(const MeasuredFrame& frame, int c, std::size_t i) {
  const double x = frame.image.plane(c)[i], r = frame.reference.plane(c)[i];
  const double scale = relmse_denominator(r);
  const double variance =
      frame.reference_variance.empty() ? 0.0 : static_cast<double>(frame.reference_variance.plane(c)[i]);
  return {(x - r) / std::sqrt(scale), variance / scale};
}

}  // namespace

double flicker(const MeasuredFrame& now, const MeasuredFrame& before) {
  double sum = 0, count = 0;
  for (int c = 0; c < now.image.channels(); ++c)
    for (std::size_t i = 0; i < now.image.pixels(); ++i) {
      const RelativeError a = relative_error_at(now, c, i), b = relative_error_at(before, c, i);
      const double change = a.value - b.value;
      if (!std::isfinite(change)) continue;
      sum += (change * change - a.reference_noise - b.reference_noise) / 2;
      ++count;
    }
  return count > 0 ? sum / count : 0;
}

}  // namespace polyrecon
