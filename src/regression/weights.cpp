#include "regression/weights.h"

#include <algorithm>
#include <limits>

#include "core/fast_math.h"
#include "core/mask.h"
#include "core/rect.h"
#include "core/simd.h"

namespace polyrecon {
namespace {

/// eps in the patch distance. It bounds the denominator for noise-free pixels: two of them are alike only if they
/// differ by about the rounding of float data, at any exposure.
constexpr Real relative_epsilon = Real(1e-10);

/// One term of the patch distance. dr, dg, db: differences of the colours. scale: the denominator.
inline Real difference(Real dr, Real dg, Real db, Real a_noise, Real b_noise, Real scale) {
  const Real noise = a_noise + (a_noise < b_noise ? a_noise : b_noise);
  return (dr * dr + dg * dg + db * db - noise) / scale;
}

/// Adds the terms between pixel a and a row of pixels b, each limited to `most`. a and b are values by plane.
POLYRECON_SIMD void add_differences(const Real* a, const Real* const* b, Real most, Real* out, int n) {
  const Real ar = a[0], ag = a[1], ab = a[2], an = a[3], as = a[4];
  const Real *br = b[0], *bg = b[1], *bb = b[2], *bn = b[3], *bs = b[4];
  for (int j = 0; j < n; ++j) {
    const Real d = difference(ar - br[j], ag - bg[j], ab - bb[j], an, bn[j], as + bs[j]);
    out[j] += d < most ? d : most;
  }
}

/// Adds the parts of the terms above `most`, which add_differences leaves out.
POLYRECON_SIMD void add_excess(const Real* a, const Real* const* b, Real most, Real* out, int n) {
  const Real ar = a[0], ag = a[1], ab = a[2], an = a[3], as = a[4];
  const Real *br = b[0], *bg = b[1], *bb = b[2], *bn = b[3], *bs = b[4];
  for (int j = 0; j < n; ++j) {
    const Real d = difference(ar - br[j], ag - bg[j], ab - bb[j], an, bn[j], as + bs[j]);
    out[j] += d < most ? Real(0) : d - most;
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
                          const PatchParams& patch, const Image* mask) {
  const int patch_radius = patch.radius;
  radius_ = window_radius;
  patch_radius_ = patch_radius;
  most_ = patch.most_around;
  bounds_ = guide.bounds();
  mask_ = mask && !mask->empty() ? mask : nullptr;
  loaded_ = grow(block, window_radius + patch_radius);
  loaded_planes_.resize(planes * loaded_.area());
  Real* out[planes];
  for (std::size_t p = 0; p < planes; ++p) out[p] = loaded_planes_.data() + p * loaded_.area();
  for (int y = loaded_.y0; y < loaded_.y1; ++y)
    for (int x = loaded_.x0; x < loaded_.x1; ++x) {
      int u = std::clamp(x, 0, bounds_.x1 - 1), v = std::clamp(y, 0, bounds_.y1 - 1);
      if (mask_ && !in_mask(*mask_, mask_->index(u, v))) nearest_in_mask(u, v);
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
  for (int px = 0; px <= 2 * patch_radius_; ++px) {
    const RowOfPixels row = pixels_of(y, px);
    add_differences(row.a, row.b, most_, sums, samples);
  }
  return sums;
}

PatchDistances::RowOfPixels PatchDistances::pixels_of(int y, int px) const {
  RowOfPixels row;
  const std::size_t size = strip_.size() / planes;
  const Real* const first = strip_.data() + static_cast<std::ptrdiff_t>(y - radius_ - loaded_.y0) * pitch_;
  for (std::size_t p = 0; p < planes; ++p) {
    row.b[p] = first + p * size + px;
    row.a[p] = row.b[p][radius_ * pitch_ + radius_];
  }
  return row;
}

void PatchDistances::sum_patches(int center_y) {
  const int samples = window_samples();
  const Real* const top = row_sums(center_y - patch_radius_);
  std::copy(top, top + samples, distance_.begin());
  for (int y = center_y - patch_radius_ + 1; y <= center_y + patch_radius_; ++y)
    add_row(row_sums(y), distance_.data(), samples);
  if (most_ == std::numeric_limits<Real>::infinity()) return;
  const RowOfPixels row = pixels_of(center_y, patch_radius_);
  add_excess(row.a, row.b, most_, distance_.data(), samples);
}

void PatchDistances::window_of(int center_x, int center_y, const std::vector<Real>& limits, Window& window) {
  if (center_x != column_) begin_column(center_x);
  sum_patches(center_y);
  const Rect inside = intersect(grow({center_x, center_y, center_x + 1, center_y + 1}, radius_), bounds_);
  if (mask_) leave_void(inside, center_x, center_y);
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

void PatchDistances::nearest_in_mask(int& x, int& y) const {
  const Rect around = intersect(grow({x, y, x + 1, y + 1}, patch_radius_), bounds_);
  int least = std::numeric_limits<int>::max(), found_x = x, found_y = y;
  for (int v = around.y0; v < around.y1; ++v)
    for (int u = around.x0; u < around.x1; ++u) {
      const int distance = (u - x) * (u - x) + (v - y) * (v - y);
      if (distance >= least || !in_mask(*mask_, mask_->index(u, v))) continue;
      least = distance;
      found_x = u;
      found_y = v;
    }
  x = found_x;
  y = found_y;
}

void PatchDistances::leave_void(const Rect& inside, int center_x, int center_y) {
  for (int y = inside.y0; y < inside.y1; ++y) {
    Real* row = distance_.data() + static_cast<std::ptrdiff_t>(y - center_y + radius_) * pitch_ + radius_ - center_x;
    for (int x = inside.x0; x < inside.x1; ++x)
      if (!in_mask(*mask_, mask_->index(x, y))) row[x] = std::numeric_limits<Real>::infinity();
  }
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
