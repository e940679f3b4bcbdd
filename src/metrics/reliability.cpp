#include "metrics/reliability.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/relmse.h"

namespace polyrecon {

std::vector<ReliabilityDecile> reliability(const Image& estimated, const Image& image, const Image& reference,
                                           const Image& reference_variance) {
  constexpr std::size_t tenths = 10;
  std::vector<ReliabilityDecile> pixels;
  pixels.reserve(image.pixels());
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    ReliabilityDecile pixel{static_cast<double>(estimated.plane(0)[i]), 0};
    for (int c = 0; c < image.channels(); ++c) {
      const double x = image.plane(c)[i], r = reference.plane(c)[i];
      const double variance = reference_variance.empty() ? 0.0 : static_cast<double>(reference_variance.plane(c)[i]);
      pixel.measured += ((x - r) * (x - r) - variance) / relmse_denominator(r) / image.channels();
    }
    if (std::isfinite(pixel.estimated) && std::isfinite(pixel.measured)) pixels.push_back(pixel);
  }
  std::stable_sort(pixels.begin(), pixels.end(),
                   [](const auto& a, const auto& b) { return a.estimated < b.estimated; });
  std::vector<ReliabilityDecile> deciles;
  for (std::size_t k = 0; k < tenths; ++k) {
    const std::size_t begin = k * pixels.size() / tenths, end = (k + 1) * pixels.size() / tenths;
    if (begin == end) continue;
    ReliabilityDecile sum;
    for (std::size_t i = begin; i < end; ++i) {
      sum.estimated += pixels[i].estimated;
      sum.measured += pixels[i].measured;
    }
    const auto count = static_cast<double>(end - begin);
    deciles.push_back({sum.estimated / count, sum.measured / count});
  }
  return deciles;
}

}  // namespace polyrecon
