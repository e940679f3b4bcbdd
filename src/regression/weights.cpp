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

/// Noise-aware squared difference of single pixels, over RGB. a and b hold rows of the six planes.
POLYRECON_SIMD void pixel_distances(const Real* const* a, const Real* const* b, Real* out, int n) {
  for (int j = 0; j < n; ++j) {
    Real excess = 0, scale = std::numeric_limits<Real>::min();
    for (int c = 0; c < 3; ++c) {
      const Real pa = a[c][j], pb = b[c][j], va = a[c + 3][j], vb = b[c + 3][j];
      const Real difference = pa - pb;
      excess += difference * difference - (va + (va < vb ? va : vb));
      scale += va + vb + relative_epsilon * (pa * pa + pb * pb);
    }
    out[j] = excess / scale;
  }
}

/// out[j] = factor x sum of in[j], in[j + step], ... (count of them).
POLYRECON_SIMD void add_strided(const Real* in, std::ptrdiff_t step, int count, Real factor, Real* out, int n) {
  for (int j = 0; j < n; ++j) out[j] = in[j];
  for (int k = 1; k < count; ++k)
    for (int j = 0; j < n; ++j) out[j] += in[j + k * step];
  for (int j = 0; j < n; ++j) out[j] *= factor;
}

/// The same for one pixel a against a row of pixels.
POLYRECON_SIMD void distances_to(const Real* a, const Real* const* b, Real* out, int n) {
  for (int j = 0; j < n; ++j) {
    Real excess = 0, scale = std::numeric_limits<Real>::min();
    for (int c = 0; c < 3; ++c) {
      const Real pa = a[c], pb = b[c][j], va = a[c + 3], vb = b[c + 3][j];
      const Real difference = pa - pb;
      excess += difference * difference - (va + (va < vb ? va : vb));
      scale += va + vb + relative_epsilon * (pa * pa + pb * pb);
    }
    out[j] = excess / scale;
  }
}

POLYRECON_SIMD void add(const Real* in, Real* out, int n) {
  for (int j = 0; j < n; ++j) out[j] += in[j];
}

POLYRECON_SIMD void scale(Real factor, Real* out, int n) {
  for (int j = 0; j < n; ++j) out[j] *= factor;
}

POLYRECON_SIMD void exponential_weights(const Real* distance, Real inverse_square, Real* weight, int n) {
  for (int j = 0; j < n; ++j) {
    const Real e = distance[j] * inverse_square;
    const auto w = static_cast<Real>(exp_minus(static_cast<float>(e < cut_exponent ? e : cut_exponent)));
    weight[j] = e < cut_exponent ? w : Real(0);
  }
}

}  // namespace

void PatchDistances::load(const Image& guide, const Image& variance, const Rect& area) {
  loaded_ = area;
  const auto width = static_cast<std::size_t>(area.width()), plane = area.area();
  planes_.resize(6 * plane);
  for (int c = 0; c < 6; ++c) {
    const Image& image = c < 3 ? guide : variance;
    for (int y = area.y0; y < area.y1; ++y) {
      const Real* row = image.row(c % 3, std::clamp(y, 0, height_ - 1));
      Real* out = planes_.data() + static_cast<std::size_t>(c) * plane + static_cast<std::size_t>(y - area.y0) * width;
      for (int x = area.x0; x < area.x1; ++x) *out++ = row[std::clamp(x, 0, width_ - 1)];
    }
  }
}

void PatchDistances::offset_distances(int dx, int dy, const Rect& area, int patch_radius) {
  const auto width = static_cast<std::size_t>(loaded_.width()), plane = loaded_.area();
  const int columns = area.width(), patch = 2 * patch_radius + 1;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y - loaded_.y0) * width + static_cast<std::size_t>(x - loaded_.x0);
  };
  for (int y = area.y0; y < area.y1; ++y) {
    const Real *a[6], *b[6];
    for (std::size_t c = 0; c < 6; ++c) {
      a[c] = planes_.data() + c * plane + at(area.x0, y);
      b[c] = planes_.data() + c * plane + at(area.x0 + dx, y + dy);
    }
    const std::size_t row = static_cast<std::size_t>(y - area.y0) * static_cast<std::size_t>(columns);
    pixel_distances(a, b, difference_.data() + row, columns);
    add_strided(difference_.data() + row, 1, patch, Real(1) / static_cast<Real>(patch * patch), row_sums_.data() + row,
                columns - patch + 1);
  }
  for (int y = 0; y + patch <= area.height(); ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns);
    add_strided(row_sums_.data() + row, columns, patch, 1, difference_.data() + row, columns - patch + 1);
  }
}

void PatchDistances::all_centers(const Rect& block, int patch_radius) {
  const Rect area = grow(block, patch_radius);
  difference_.resize(area.area());
  row_sums_.resize(area.area());
  const std::size_t window_size = distance_.size() / center_x_.size();
  std::size_t offset = 0;
  for (int dy = -radius_; dy <= radius_; ++dy)
    for (int dx = -radius_; dx <= radius_; ++dx, ++offset) {
      offset_distances(dx, dy, area, patch_radius);
      for (std::size_t k = 0; k < center_x_.size(); ++k)
        distance_[k * window_size + offset] =
            difference_[static_cast<std::size_t>(center_y_[k] - block.y0) * static_cast<std::size_t>(area.width()) +
                        static_cast<std::size_t>(center_x_[k] - block.x0)];
    }
}

void PatchDistances::one_center(std::size_t center, int patch_radius) {
  const int side = 2 * radius_ + 1, patch = 2 * patch_radius + 1;
  const auto width = static_cast<std::size_t>(loaded_.width()), plane = loaded_.area();
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y - loaded_.y0) * width + static_cast<std::size_t>(x - loaded_.x0);
  };
  difference_.resize(static_cast<std::size_t>(side));
  row_sums_.resize(static_cast<std::size_t>(side));
  Real* row = distance_.data() + center * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  for (int dy = -radius_; dy <= radius_; ++dy, row += side) {
    std::fill(row, row + side, Real(0));
    for (int py = -patch_radius; py <= patch_radius; ++py) {
      // Summed and scaled in the order of offset_distances: which of the two is run must not show in any bit.
      std::fill(row_sums_.begin(), row_sums_.end(), Real(0));
      for (int px = -patch_radius; px <= patch_radius; ++px) {
        const int x = center_x_[center] + px, y = center_y_[center] + py;
        const Real* b[6];
        Real a[6];
        for (std::size_t c = 0; c < 6; ++c) {
          a[c] = planes_[c * plane + at(x, y)];
          b[c] = planes_.data() + c * plane + at(x - radius_, y + dy);
        }
        distances_to(a, b, difference_.data(), side);
        add(difference_.data(), row_sums_.data(), side);
      }
      scale(Real(1) / static_cast<Real>(patch * patch), row_sums_.data(), side);
      add(row_sums_.data(), row, side);
    }
  }
}

void PatchDistances::compute(const Image& guide, const Image& variance, const Rect& block,
                             const std::vector<int>& center_x, const std::vector<int>& center_y, int window_radius,
                             int patch_radius) {
  radius_ = window_radius;
  width_ = guide.width();
  height_ = guide.height();
  center_x_ = center_x;
  center_y_ = center_y;
  const int side = 2 * window_radius + 1, patch = 2 * patch_radius + 1;
  distance_.resize(center_x.size() * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  load(guide, variance, grow(block, window_radius + patch_radius));
  // Sums shared between the patches of a whole block pay only where centres are dense.
  if (center_x.size() * static_cast<std::size_t>(patch * patch) > block.area())
    all_centers(block, patch_radius);
  else
    for (std::size_t k = 0; k < center_x.size(); ++k) one_center(k, patch_radius);
}

void PatchDistances::window_of(std::size_t center, Real limit, Window& window) const {
  const int side = 2 * radius_ + 1, cx = center_x_[center], cy = center_y_[center];
  const Real* distance = distance_.data() + center * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  const int x0 = std::max(cx - radius_, 0), x1 = std::min(cx + radius_, width_ - 1);
  const int y0 = std::max(cy - radius_, 0), y1 = std::min(cy + radius_, height_ - 1);
  std::size_t count = 0;
  for (int y = y0; y <= y1; ++y) {
    const Real* row = distance + static_cast<std::ptrdiff_t>(y - cy + radius_) * side - cx + radius_;
    for (int x = x0; x <= x1; ++x) {
      const Real d = row[x];
      if (!(d < limit)) continue;
      window.x[count] = x;
      window.y[count] = y;
      window.distance[count] = d > 0 ? d : 0;
      ++count;
    }
  }
  window.count = static_cast<int>(count);
}

double kernel_weights(const Window& window, Real bandwidth, Real* weight) {
  exponential_weights(window.distance.data(), 1 / (bandwidth * bandwidth), weight, window.padded);
  std::fill(weight + window.count, weight + window.padded, Real(0));
  double sum = 0;
  for (int j = 0; j < window.count; ++j) sum += static_cast<double>(weight[j]);
  return sum;
}

}  // namespace polyrecon
