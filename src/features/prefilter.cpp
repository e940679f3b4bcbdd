#include "features/prefilter.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/fast_math.h"
#include "core/parallel.h"
#include "core/simd.h"

namespace polyrecon {
namespace {

constexpr Real cut_exponent = 30;

/// max(v, mean of v over 3 x 3): single pixels of too small a variance would refuse every neighbour.
Image widened_variance(const Image& variance) {
  Image out = variance;
  Progress silent;
  parallel_for(static_cast<std::size_t>(out.height()), silent, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const Rect around = intersect(grow({x, y, x + 1, y + 1}, 1), out.bounds());
        double sum = 0;
        for (int v = around.y0; v < around.y1; ++v)
          for (int u = around.x0; u < around.x1; ++u) sum += static_cast<double>(variance.at(u, v, c));
        out.at(x, y, c) = std::max(variance.at(x, y, c), static_cast<Real>(sum / static_cast<double>(around.area())));
      }
  });
  return out;
}

POLYRECON_SIMD void add_distances(const Real* a, const Real* b, const Real* va, const Real* vb, Real factor, Real* out,
                                  int n) {
  for (int i = 0; i < n; ++i) {
    const Real d = a[i] - b[i], noise = va[i] + (va[i] < vb[i] ? va[i] : vb[i]);
    out[i] += factor * (d * d - noise) /
              (va[i] + vb[i] + Real(1e-10) * (a[i] * a[i] + b[i] * b[i]) + std::numeric_limits<Real>::min());
  }
}

POLYRECON_SIMD void add_rows(const Real* in, Real factor, Real* out, int n) {
  for (int i = 0; i < n; ++i) out[i] += factor * in[i];
}

POLYRECON_SIMD void weights_of(Real* distance, Real inverse_square, int n) {
  for (int i = 0; i < n; ++i) {
    const Real e = std::clamp(distance[i] * inverse_square, Real(0), cut_exponent);
    distance[i] = static_cast<Real>(exp_minus(static_cast<float>(e)));
  }
}

POLYRECON_SIMD void accumulate(const Real* weight, const Real* in, double* out, int n) {
  for (int i = 0; i < n; ++i) out[i] += static_cast<double>(weight[i]) * static_cast<double>(in[i]);
}

/// A band of rows with a border of repeated pixels: what the offsets are taken from.
struct Padded {
  int width, height, channels, margin;
  std::vector<Real> samples;

  Padded(const Image& image, const Rect& rows, int border)
      : width(image.width() + 2 * border),
        height(rows.height() + 2 * border),
        channels(image.channels()),
        margin(border) {
    samples.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                   static_cast<std::size_t>(channels));
    for (int c = 0; c < channels; ++c)
      for (int y = 0; y < height; ++y) {
        const Real* in = image.row(c, std::clamp(rows.y0 + y - border, 0, image.height() - 1));
        for (int x = 0; x < width; ++x)
          at(x - border, y - border, c)[0] = in[std::clamp(x - border, 0, image.width() - 1)];
      }
  }
  Real* at(int x, int y, int c) {
    return samples.data() +
           (static_cast<std::size_t>(c) * static_cast<std::size_t>(height) + static_cast<std::size_t>(y + margin)) *
               static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x + margin);
  }
};

/// Filters the rows `band` of source with weights measured on guide.
void filter_band(const Image& source, const Image& guide, const Image& variance, const Rect& band,
                 const PrefilterParams& p, Image& out) {
  const int margin = p.search_radius + p.patch_radius, width = source.width(), patch = 2 * p.patch_radius + 1;
  const int wide = width + 2 * p.patch_radius, high = band.height() + 2 * p.patch_radius;
  Padded values(guide, band, margin), noise(variance, band, margin);
  std::vector<Real> pixel(static_cast<std::size_t>(wide) * static_cast<std::size_t>(high));
  std::vector<Real> row_sum(static_cast<std::size_t>(wide)), distance(static_cast<std::size_t>(width));
  const auto plane = static_cast<std::size_t>(width) * static_cast<std::size_t>(band.height());
  std::vector<double> sum(plane * static_cast<std::size_t>(source.channels()), 0.0), total(plane, 0.0);
  const std::vector<Real> ones(static_cast<std::size_t>(width), Real(1));
  for (int dy = -p.search_radius; dy <= p.search_radius; ++dy)
    for (int dx = -p.search_radius; dx <= p.search_radius; ++dx) {
      std::fill(pixel.begin(), pixel.end(), Real(0));
      for (int y = 0; y < high; ++y)
        for (int c = 0; c < source.channels(); ++c) {
          const int py = y - p.patch_radius, px = -p.patch_radius;
          add_distances(values.at(px, py, c), values.at(px + dx, py + dy, c), noise.at(px, py, c),
                        noise.at(px + dx, py + dy, c), Real(1) / static_cast<Real>(source.channels()),
                        pixel.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(wide), wide);
        }
      for (int y = std::max(0, -dy - band.y0); y < std::min(band.height(), source.height() - dy - band.y0); ++y) {
        std::fill(row_sum.begin(), row_sum.end(), Real(0));
        for (int k = 0; k < patch; ++k)
          add_rows(pixel.data() + static_cast<std::size_t>(y + k) * static_cast<std::size_t>(wide), Real(1),
                   row_sum.data(), wide);
        std::fill(distance.begin(), distance.end(), Real(0));
        for (int k = 0; k < patch; ++k)
          add_rows(row_sum.data() + k, Real(1) / static_cast<Real>(patch * patch), distance.data(), width);
        weights_of(distance.data(), static_cast<Real>(1 / (p.bandwidth * p.bandwidth)), width);
        const int x0 = std::max(0, -dx), x1 = std::min(width, width - dx);
        if (x0 >= x1) continue;
        const std::size_t at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x0);
        accumulate(distance.data() + x0, ones.data(), total.data() + at, x1 - x0);
        for (int c = 0; c < source.channels(); ++c)
          accumulate(distance.data() + x0, source.row(c, band.y0 + y + dy) + x0 + dx,
                     sum.data() + static_cast<std::size_t>(c) * plane + at, x1 - x0);
      }
    }
  for (int c = 0; c < source.channels(); ++c)
    for (int y = 0; y < band.height(); ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        out.at(x, band.y0 + y, c) = static_cast<Real>(sum[static_cast<std::size_t>(c) * plane + i] / total[i]);
      }
}

}  // namespace

std::array<Image, 2> prefilter(const std::array<Image, 2>& halves, const Image& variance, const PrefilterParams& params,
                               Progress& progress) {
  constexpr int band_height = 32;
  const Image noise = widened_variance(variance);
  const int width = variance.width(), height = variance.height();
  std::array<Image, 2> out{Image(width, height, variance.channels()), Image(width, height, variance.channels())};
  const auto bands = static_cast<std::size_t>((height + band_height - 1) / band_height);
  parallel_for(2 * bands, progress, [&](std::size_t i) {
    const std::size_t h = i % 2;
    const int y0 = static_cast<int>(i / 2) * band_height;
    filter_band(halves[h], halves[1 - h], noise, {0, y0, width, std::min(y0 + band_height, height)}, params, out[h]);
  });
  return out;
}

}  // namespace polyrecon
