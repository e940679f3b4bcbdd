#include "noise/feature_noise.h"

#include <algorithm>
#include <cmath>

#include "core/gaussian.h"
#include "core/mask.h"
#include "core/parallel.h"

namespace polyrecon {
namespace {

// docs/lab/2026-12-01-single-renders.md has the figures of other values.
constexpr double sigma = 2.5;  // pixels
constexpr double least_part = 0.5, full_part = 0.8;

/// Variance of white noise minus its blur, over that of the noise: 1 - 2 G_0 + sum G^2 of the two-dimensional kernel.
double noise_beyond_blur() {
  double sum = 0, squares = 0;
  const int radius = gaussian_radius(sigma);
  for (int i = -radius; i <= radius; ++i) {
    const double g = std::exp(-i * i / (2 * sigma * sigma));
    sum += g;
    squares += g * g;
  }
  const double middle = 1 / (sum * sum), energy = squares / (sum * sum);
  return 1 - 2 * middle + energy * energy;
}

Real smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return static_cast<Real>(t * t * (3 - 2 * t));
}

}  // namespace

Image noise_in_variation(const Image& feature, const Image& variance, const Image& mask) {
  Image variation = gaussian_blur(feature, sigma, mask);
  for_rows(feature.height(), [&](int y) {
    for (int c = 0; c < feature.channels(); ++c) {
      const Real* f = feature.row(c, y);
      Real* v = variation.row(c, y);
      for (int x = 0; x < feature.width(); ++x) v[x] = (f[x] - v[x]) * (f[x] - v[x]);
    }
  });
  variation = gaussian_blur(variation, sigma, mask);
  Image out = gaussian_blur(variance, sigma, mask);
  const double of_noise = noise_beyond_blur();
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const double noise = of_noise * static_cast<double>(out.at(x, y, c));
        const auto all = static_cast<double>(variation.at(x, y, c));
        const bool known = all > 0 && in_mask(mask, out.index(x, y));
        out.at(x, y, c) = known ? smooth_step((noise / all - least_part) / (full_part - least_part)) : Real(0);
      }
  });
  return out;
}

Image flattened(Image image, const Image& part, const Image& mask) {
  const Image blur = gaussian_blur(image, sigma, mask);
  for_rows(image.height(), [&](int y) {
    for (int c = 0; c < image.channels(); ++c) {
      const Real *share = part.row(c, y), *smooth = blur.row(c, y);
      Real* values = image.row(c, y);
      for (int x = 0; x < image.width(); ++x)
        if (share[x] > 0) values[x] += share[x] * (smooth[x] - values[x]);
    }
  });
  return image;
}

}  // namespace polyrecon
