#include "polyrecon/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/relmse.h"
#include "polyrecon/error.h"

namespace polyrecon {

Score score(const Image& image, const Image& reference, const Image& reference_variance) {
  if (!image.same_shape(reference) || (!reference_variance.empty() && !reference_variance.same_shape(reference)))
    throw Error(ExitCode::BadInput, "an image and its reference must have the same size and channels");
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Score result;
  const std::size_t pixels = image.pixels();
  std::vector<double> error(pixels, 0.0);
  std::vector<bool> bad(pixels, false);
  double sum = 0, reference_sum = 0;
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < pixels; ++i) {
      const double sample = image.plane(c)[i], r = reference.plane(c)[i];
      const double x = std::isfinite(sample) ? sample : 0.0;
      const double variance = reference_variance.empty() ? 0.0 : reference_variance.plane(c)[i];
      if (!std::isfinite(sample)) bad[i] = true;
      error[i] += ((x - r) * (x - r) - variance) / relmse_denominator(r) / image.channels();
      sum += x;
      reference_sum += r;
    }
  const auto kept = static_cast<std::size_t>(static_cast<double>(pixels) * 0.999);
  const auto end = error.begin() + static_cast<std::ptrdiff_t>(kept);
  result.relative_mse = std::accumulate(error.begin(), error.end(), 0.0) / static_cast<double>(pixels);
  std::nth_element(error.begin(), end, error.end());
  result.trimmed = kept > 0 ? std::accumulate(error.begin(), end, 0.0) / static_cast<double>(kept) : nan;
  result.energy = reference_sum != 0 ? sum / reference_sum - 1 : nan;
  result.bad = static_cast<std::size_t>(std::count(bad.begin(), bad.end(), true));
  return result;
}

Image relative_error(const Image& image, const Image& reference) {
  Image out(image.width(), image.height(), 1);
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i) {
      const double x = image.plane(c)[i], r = reference.plane(c)[i];
      out.plane(0)[i] += static_cast<Real>(relative_squared_error(x, r) / image.channels());
    }
  return out;
}

}  // namespace polyrecon
