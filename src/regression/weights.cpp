#include "regression/weights.h"

#include <algorithm>
#include <limits>

#include "core/fast_math.h"
#include "core/simd.h"

namespace polyrecon {
namespace {

/// What a difference of colours is divided by at least, relative to their square: keeps noise-free pixels apart by more
/// than the rounding of float data, at any exposure.
constexpr Real relative_epsilon = Real(1e-10);

constexpr int row_lanes = 8;  ///< Rows around a centre are padded to whole vectors of this many samples.

/// Adds the noise-aware squared differences between pixel a and a row of pixels; a and b: the planes of `load`.
POLYRECON_SIMD void add_differences(const Real* a, const Real* const* b, Real* out, int n) {
  const Real ar = a[0], ag = a[1], ab = a[2], an = a[3], as = a[4];
  const Real *br = b[0], *bg = b[1], *bb = b[2], *bn = b[3], *bs = b[4];
  for (int j = 0; j < n; ++j) {
    const Real dr = ar - br[j], dg = ag - bg[j], db = ab - bb[j];
    const Real noise = an + (an < bn[j] ? an : bn[j]);
    out[j] += (dr * dr + dg * dg + db * db - noise) / (as + bs[j]);
  }
}

POLYRECON_SIMD void exponential_weights(const Real* distance, Real inverse_square, Real* weight, int n) {
  for (int j = 0; j < n; ++j) {
    const Real e = distance[j] * inverse_square;
    const auto w = static_cast<Real>(exp_minus(static_cast<float>(e < cut_exponent ? e : cut_exponent)));
    weight[j] = e < cut_exponent ? w : Real(0);
  }
}

POLYRECON_SIMD double sum_of(const Real* values, int n) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int j = 0; j < n; ++j) sum += static_cast<double>(values[j]);
  return sum;
}

}  // namespace

void PatchDistances::load(const Image& guide, const Image& variance, const Rect& block, int window_radius,
                          int patch_radius) {
  radius_ = window_radius;
  patch_radius_ = patch_radius;
  bounds_ = guide.bounds();
  loaded_ = grow(block, window_radius + patch_radius);
  loaded_planes_.resize(planes * loaded_.area());
  Real* out[planes];
  for (std::size_t p = 0; p < planes; ++p) out[p] = loaded_planes_.data() + p * loaded_.area();
  for (int y = loaded_.y0; y < loaded_.y1; ++y)
    for (int x = loaded_.x0; x < loaded_.x1; ++x) {
      const int u = std::clamp(x, 0, bounds_.x1 - 1), v = std::clamp(y, 0, bounds_.y1 - 1);
      Real noise = 0, square = 0;
      for (int c = 0; c < 3; ++c) {
        const Real color = guide.at(u, v, c);
        *out[c]++ = color;
        noise += variance.at(u, v, c);
        square += color * color;
      }
      *out[3]++ = noise;
      *out[4]++ = noise + relative_epsilon * square + std::numeric_limits<Real>::min();
    }
}

void PatchDistances::surround(int center_x, int center_y) {
  const int reach = radius_ + patch_radius_, side = 2 * reach + 1;
  pitch_ = (side + row_lanes - 1) / row_lanes * row_lanes;
  const std::size_t size = static_cast<std::size_t>(side) * static_cast<std::size_t>(pitch_);
  const auto width = static_cast<std::size_t>(loaded_.width());
  const std::size_t first = static_cast<std::size_t>(center_y - reach - loaded_.y0) * width +
                            static_cast<std::size_t>(center_x - reach - loaded_.x0);
  around_.resize(planes * size);
  for (std::size_t p = 0; p < planes; ++p)
    for (std::size_t y = 0; y < static_cast<std::size_t>(side); ++y)
      std::copy_n(loaded_planes_.data() + p * loaded_.area() + first + y * width, side,
                  around_.data() + p * size + y * static_cast<std::size_t>(pitch_));
}

void PatchDistances::sum_patches() {
  const int side = 2 * radius_ + 1, patch = 2 * patch_radius_ + 1;
  const std::size_t size = around_.size() / planes;
  const int pixels = (side - 1) * pitch_ + side;  // ends with the last pixel of the last row: the next plane follows
  distance_.assign(static_cast<std::size_t>(pixels), Real(0));
  for (int py = 0; py < patch; ++py)
    for (int px = 0; px < patch; ++px) {
      const auto center = static_cast<std::size_t>((radius_ + py) * pitch_ + radius_ + px);
      const Real* b[planes];
      Real a[planes];
      for (std::size_t p = 0; p < planes; ++p) {
        a[p] = around_[p * size + center];
        b[p] = around_.data() + p * size + static_cast<std::ptrdiff_t>(py) * pitch_ + px;
      }
      add_differences(a, b, distance_.data(), pixels);
    }
}

void PatchDistances::window_of(int center_x, int center_y, Real limit, Window& window) {
  surround(center_x, center_y);
  sum_patches();
  const auto patch_area = static_cast<Real>((2 * patch_radius_ + 1) * (2 * patch_radius_ + 1));
  const Rect inside = intersect(grow({center_x, center_y, center_x + 1, center_y + 1}, radius_), bounds_);
  std::size_t count = 0;
  for (int y = inside.y0; y < inside.y1; ++y) {
    const Real* row =
        distance_.data() + static_cast<std::ptrdiff_t>(y - center_y + radius_) * pitch_ - center_x + radius_;
    for (int x = inside.x0; x < inside.x1; ++x) {
      // Written whether it stays or not, as no processor foresees which: the next one takes its place.
      const Real d = row[x];
      window.x[count] = x;
      window.y[count] = y;
      window.distance[count] = d > 0 ? d / patch_area : 0;
      count += d < limit * patch_area;
    }
  }
  window.count = static_cast<int>(count);
}

double kernel_weights(const Window& window, Real bandwidth, Real* weight) {
  exponential_weights(window.distance.data(), 1 / (bandwidth * bandwidth), weight, window.padded);
  std::fill(weight + window.count, weight + window.padded, Real(0));
  return sum_of(weight, window.padded);
}

}  // namespace polyrecon
