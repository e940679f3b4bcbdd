#include "core/gaussian.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/mask.h"
#include "core/parallel.h"
#include "core/simd.h"

namespace polyrecon {
namespace {

POLYRECON_SIMD void accumulate(const Real* in, double tap, double* sum, int n) {
  for (int i = 0; i < n; ++i) sum[i] += tap * static_cast<double>(in[i]);
}

POLYRECON_SIMD void divide(const double* sum, const double* weight, Real* out, int n) {
  for (int i = 0; i < n; ++i) out[i] = static_cast<Real>(sum[i] / weight[i]);
}

void blur_columns(const Image& in, const std::vector<double>& taps, int c, int y, Image& out) {
  const int radius = static_cast<int>(taps.size()) - 1, width = in.width();
  std::vector<double> sum(static_cast<std::size_t>(width), 0.0);
  double weight = 0;
  for (int k = std::max(-radius, -y); k <= std::min(radius, in.height() - 1 - y); ++k) {
    const double tap = taps[static_cast<std::size_t>(std::abs(k))];
    accumulate(in.row(c, y + k), tap, sum.data(), width);
    weight += tap;
  }
  const std::vector<double> weights(static_cast<std::size_t>(width), weight);
  divide(sum.data(), weights.data(), out.row(c, y), width);
}

/// Sums of the values around each pixel of a row, times the taps.
std::vector<double> row_sums(const Real* in, const std::vector<double>& taps, int width) {
  const int radius = static_cast<int>(taps.size()) - 1;
  std::vector<double> sum(static_cast<std::size_t>(width), 0.0);
  for (int k = -radius; k <= radius; ++k) {
    const int begin = std::max(0, -k), end = std::min(width, width - k);
    if (begin >= end) continue;
    accumulate(in + begin + k, taps[static_cast<std::size_t>(std::abs(k))], sum.data() + begin, end - begin);
  }
  return sum;
}

}  // namespace

int gaussian_radius(double sigma) { return static_cast<int>(std::ceil(3 * sigma)); }

Image gaussian_blur(const Image& image, double sigma) {
  std::vector<double> taps;
  for (int k = 0; k <= gaussian_radius(sigma); ++k) taps.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
  Image between(image.width(), image.height(), image.channels()), out = between;
  const std::vector<Real> ones(static_cast<std::size_t>(image.width()), Real(1));
  const std::vector<double> weights = row_sums(ones.data(), taps, image.width());
  for (int c = 0; c < image.channels(); ++c) {
    for_rows(image.height(), [&](int y) { blur_columns(image, taps, c, y, between); });
    for_rows(image.height(), [&](int y) {
      divide(row_sums(between.row(c, y), taps, image.width()).data(), weights.data(), out.row(c, y), image.width());
    });
  }
  return out;
}

Image gaussian_blur(const Image& image, double sigma, const Image& mask) {
  if (mask.empty()) return gaussian_blur(image, sigma);
  return divided_by_share(gaussian_blur(outside_set_to(0, mask, image), sigma), gaussian_blur(mask, sigma));
}

}  // namespace polyrecon
