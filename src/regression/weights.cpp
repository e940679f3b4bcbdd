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

POLYRECON_SIMD void add_row(const Real* row, Real* out, int n) {
  for (int j = 0; j < n; ++j) out[j] += row[j];
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
  pitch_ = 2 * (window_radius + patch_radius) + 1;
  strip_.resize(planes * static_cast<std::size_t>(loaded_.height()) * static_cast<std::size_t>(pitch_));
  summed_.resize(static_cast<std::size_t>(2 * patch_radius + 1));
  distance_.resize(static_cast<std::size_t>(window_samples()));
  sums_.resize(summed_.size() * distance_.size());
  near_.resize(static_cast<std::size_t>((2 * radius_ + 1) * (2 * radius_ + 1)) + 1);
  column_ = nowhere;
}

int PatchDistances::window_samples() const { return 2 * radius_ * pitch_ + 2 * radius_ + 1; }

std::size_t PatchDistances::slot_of(int y) const {
  return static_cast<std::size_t>((y - loaded_.y0) % (2 * patch_radius_ + 1));
}

void PatchDistances::begin_column(int center_x) {
  column_ = center_x;
  copied_from_ = copied_to_ = nowhere;
  std::fill(summed_.begin(), summed_.end(), nowhere);
}

void PatchDistances::copy_rows(int y0, int y1) {
  if (y0 < copied_from_ || y0 > copied_to_) copied_from_ = copied_to_ = y0;
  const std::size_t size = strip_.size() / planes;
  for (int y = copied_to_; y < y1; ++y) {
    const auto row = static_cast<std::size_t>(y - loaded_.y0);
    const Real* from =
        loaded_planes_.data() + row * static_cast<std::size_t>(loaded_.width()) + column_ - pitch_ / 2 - loaded_.x0;
    Real* to = strip_.data() + row * static_cast<std::size_t>(pitch_);
    for (std::size_t p = 0; p < planes; ++p) std::copy_n(from + p * loaded_.area(), pitch_, to + p * size);
  }
  copied_to_ = std::max(copied_to_, y1);
}

const Real* PatchDistances::row_sums(int y) {
  const int samples = window_samples();
  Real* const sums = sums_.data() + slot_of(y) * static_cast<std::size_t>(samples);
  if (summed_[slot_of(y)] == y) return sums;
  summed_[slot_of(y)] = y;
  copy_rows(y - radius_, y + radius_ + 1);
  std::fill(sums, sums + samples, Real(0));
  const std::size_t size = strip_.size() / planes;
  const Real* const first = strip_.data() + static_cast<std::ptrdiff_t>(y - radius_ - loaded_.y0) * pitch_;
  for (int px = 0; px <= 2 * patch_radius_; ++px) {
    const Real* b[planes];
    Real a[planes];
    for (std::size_t p = 0; p < planes; ++p) {
      b[p] = first + p * size + px;
      a[p] = b[p][radius_ * pitch_ + radius_];
    }
    add_differences(a, b, sums, samples);
  }
  return sums;
}

void PatchDistances::sum_patches(int center_y) {
  const int samples = window_samples();
  const Real* const top = row_sums(center_y - patch_radius_);
  std::copy(top, top + samples, distance_.begin());
  for (int y = center_y - patch_radius_ + 1; y <= center_y + patch_radius_; ++y)
    add_row(row_sums(y), distance_.data(), samples);
}

void PatchDistances::window_of(int center_x, int center_y, const std::vector<Real>& limits, Window& window) {
  if (center_x != column_) begin_column(center_x);
  sum_patches(center_y);
  const Rect inside = intersect(grow({center_x, center_y, center_x + 1, center_y + 1}, radius_), bounds_);
  const std::size_t near = find_near(inside, center_x, center_y, limits.back());
  const auto patch_area = static_cast<Real>((2 * patch_radius_ + 1) * (2 * patch_radius_ + 1));
  std::size_t count = 0;
  window.within.clear();
  Real from = std::numeric_limits<Real>::lowest();
  for (const Real limit : limits) {
    for (std::size_t k = 0; k < near; ++k) {
      const int x = near_[k] % 64, y = near_[k] / 64;
      const Real d = distance_[static_cast<std::size_t>(y * pitch_ + x)];
      window.x[count] = center_x - radius_ + x;
      window.y[count] = center_y - radius_ + y;
      window.distance[count] = d > 0 ? d / patch_area : 0;
      count += static_cast<std::size_t>(d >= from) & static_cast<std::size_t>(d < limit * patch_area);
    }
    window.within.push_back(static_cast<int>(count));
    from = limit * patch_area;
  }
  window.count = static_cast<int>(count);
}

std::size_t PatchDistances::find_near(const Rect& inside, int center_x, int center_y, Real limit) {
  const Real end = limit * static_cast<Real>((2 * patch_radius_ + 1) * (2 * patch_radius_ + 1));
  const int first_x = center_x - radius_, first_y = center_y - radius_;
  std::size_t count = 0;
  for (int y = inside.y0 - first_y; y < inside.y1 - first_y; ++y) {
    const Real* row = distance_.data() + static_cast<std::ptrdiff_t>(y) * pitch_;
    for (int x = inside.x0 - first_x; x < inside.x1 - first_x; ++x) {
      near_[count] = 64 * y + x;
      count += row[x] < end;
    }
  }
  return count;
}

double kernel_weights(const Window& window, Real bandwidth, Real* weight) {
  exponential_weights(window.distance.data(), 1 / (bandwidth * bandwidth), weight, window.padded);
  std::fill(weight + window.count, weight + window.padded, Real(0));
  return sum_of(weight, window.padded);
}

}  // namespace polyrecon
