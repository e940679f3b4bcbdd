#include "features/prefilter.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/fast_math.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "core/simd.h"

namespace polyrecon {
namespace {

constexpr Real cut_exponent = 30;

POLYRECON_SIMD void add_values(const Real* in, double* sum, int n) {
  for (int i = 0; i < n; ++i) sum[i] += static_cast<double>(in[i]);
}

/// max(v, mean of v over 3 x 3). A single pixel with too small a variance would give no neighbour a weight.
Image widened_variance(const Image& variance) {
  Image out(variance.width(), variance.height(), variance.channels());
  const int width = out.width();
  for_rows(out.height(), [&](int y) {
    const int top = std::max(y - 1, 0), bottom = std::min(y + 2, out.height());
    std::vector<double> columns(static_cast<std::size_t>(width) + 2);  // one more on either side
    for (int c = 0; c < out.channels(); ++c) {
      std::fill(columns.begin(), columns.end(), 0.0);
      for (int v = top; v < bottom; ++v) add_values(variance.row(c, v), columns.data() + 1, width);
      const Real* noise = variance.row(c, y);
      Real* wide = out.row(c, y);
      for (int x = 0; x < width; ++x) {
        const double* around = columns.data() + x;
        const int count = (std::min(x + 2, width) - std::max(x - 1, 0)) * (bottom - top);
        wide[x] = std::max(noise[x], static_cast<Real>((around[0] + around[1] + around[2]) / count));
      }
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

/// out[i] = factor * (in[i] + in[i + step] + ... + in[i + (patch - 1) * step]).
template <int patch>
POLYRECON_SIMD void patch_sums(const Real* in, std::ptrdiff_t step, Real factor, Real* out, int n) {
  for (int i = 0; i < n; ++i) {
    Real sum = in[i];
    for (int k = 1; k < patch; ++k) sum += in[i + k * step];
    out[i] = factor * sum;
  }
}

void add_patch(int patch, const Real* in, std::ptrdiff_t step, Real factor, Real* out, int n) {
  switch (patch) {
    case 1:
      return patch_sums<1>(in, step, factor, out, n);
    case 3:
      return patch_sums<3>(in, step, factor, out, n);
    case 5:
      return patch_sums<5>(in, step, factor, out, n);
    case 7:
      return patch_sums<7>(in, step, factor, out, n);
    default:
      return patch_sums<9>(in, step, factor, out, n);
  }
}

/// Replaces distances by weights. A distance that overflowed to NaN gets the smallest weight.
POLYRECON_SIMD void weights_of(Real* distance, Real inverse_square, int n) {
  for (int i = 0; i < n; ++i) {
    const Real e = std::max(distance[i] * inverse_square, Real(0));
    distance[i] = static_cast<Real>(exp_minus(static_cast<float>(e < cut_exponent ? e : cut_exponent)));
  }
}

POLYRECON_SIMD void accumulate(const Real* weight, const Real* in, double* out, int n) {
  for (int i = 0; i < n; ++i) out[i] += static_cast<double>(weight[i]) * static_cast<double>(in[i]);
}

/// A tile of an image with a border, which holds the pixels around the tile and repeats those at the image's edge.
struct Padded {
  int width, height, margin;
  std::vector<Real> samples;

  Padded(const Image& image, const Rect& tile, int border)
      : width(tile.width() + 2 * border), height(tile.height() + 2 * border), margin(border) {
    samples.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                   static_cast<std::size_t>(image.channels()));
    for (int c = 0; c < image.channels(); ++c)
      for (int y = 0; y < height; ++y) {
        const Real* in = image.row(c, std::clamp(tile.y0 + y - border, 0, image.height() - 1));
        Real* out = at(-border, y - border, c);
        for (int x = 0; x < width; ++x) out[x] = in[std::clamp(tile.x0 + x - border, 0, image.width() - 1)];
      }
  }
  Real* at(int x, int y, int c) {
    return samples.data() +
           (static_cast<std::size_t>(c) * static_cast<std::size_t>(height) + static_cast<std::size_t>(y + margin)) *
               static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x + margin);
  }
};

/// Filters one tile of source with weights measured on guide.
class TileFilter {
 public:
  TileFilter(const Image& source, const Image& guide, const Image& variance, const Image& mask, const Rect& tile,
             const PrefilterParams& params)
      : source_(source),
        mask_(mask),
        tile_(tile),
        params_(params),
        values_(guide, tile, params.search_radius + params.patch_radius),
        noise_(variance, tile, params.search_radius + params.patch_radius),
        wide_(tile.width() + 2 * params.patch_radius),
        pixel_(static_cast<std::size_t>(wide_) * static_cast<std::size_t>(tile.height() + 2 * params.patch_radius)),
        row_sum_(static_cast<std::size_t>(wide_)),
        weight_(static_cast<std::size_t>(tile.width())),
        sum_(tile.area() * static_cast<std::size_t>(source.channels()), 0.0),
        total_(tile.area(), 0.0) {}

  void run(Image& out) {
    for (int dy = -params_.search_radius; dy <= params_.search_radius; ++dy)
      for (int dx = -params_.search_radius; dx <= params_.search_radius; ++dx) {
        measure(dx, dy);
        for (int y = 0; y < tile_.height(); ++y) {
          const int row = tile_.y0 + y + dy;
          if (row >= 0 && row < source_.height()) add_row(dx, dy, y);
        }
      }
    for (int c = 0; c < source_.channels(); ++c)
      for (int y = 0; y < tile_.height(); ++y)
        for (int x = 0; x < tile_.width(); ++x)
          if (total_[at(x, y)] > 0)  // else no pixel around is inside the mask
            out.at(tile_.x0 + x, tile_.y0 + y, c) =
                static_cast<Real>(sum_[static_cast<std::size_t>(c) * tile_.area() + at(x, y)] / total_[at(x, y)]);
  }

 private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(tile_.width()) + static_cast<std::size_t>(x);
  }

  /// Computes the distance of each pixel to the one at an offset.
  void measure(int dx, int dy) {
    const int r = params_.patch_radius, channels = source_.channels();
    std::fill(pixel_.begin(), pixel_.end(), Real(0));
    for (int y = 0; y < tile_.height() + 2 * r; ++y)
      for (int c = 0; c < channels; ++c)
        add_distances(values_.at(-r, y - r, c), values_.at(dx - r, y + dy - r, c), noise_.at(-r, y - r, c),
                      noise_.at(dx - r, y + dy - r, c), Real(1) / static_cast<Real>(channels),
                      pixel_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(wide_), wide_);
  }

  /// Turns the distances of a row into weights of patches, and adds the pixels at the offset with these weights.
  void add_row(int dx, int dy, int y) {
    const int patch = 2 * params_.patch_radius + 1;
    add_patch(patch, pixel_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(wide_), wide_, 1,
              row_sum_.data(), wide_);
    add_patch(patch, row_sum_.data(), 1, Real(1) / static_cast<Real>(patch * patch), weight_.data(), tile_.width());
    weights_of(weight_.data(), static_cast<Real>(1 / (params_.bandwidth * params_.bandwidth)), tile_.width());
    const int x0 = std::max(0, -dx - tile_.x0), x1 = std::min(tile_.width(), source_.width() - dx - tile_.x0);
    if (x0 >= x1) return;
    const std::size_t first = source_.index(tile_.x0 + x0 + dx, tile_.y0 + y + dy);
    if (!mask_.empty())
      for (int x = x0; x < x1; ++x)
        if (!in_mask(mask_, first + static_cast<std::size_t>(x - x0))) weight_[static_cast<std::size_t>(x)] = 0;
    add_values(weight_.data() + x0, total_.data() + at(x0, y), x1 - x0);
    for (int c = 0; c < source_.channels(); ++c)
      accumulate(weight_.data() + x0, source_.row(c, tile_.y0 + y + dy) + tile_.x0 + x0 + dx,
                 sum_.data() + static_cast<std::size_t>(c) * tile_.area() + at(x0, y), x1 - x0);
  }

  const Image& source_;
  const Image& mask_;
  Rect tile_;
  const PrefilterParams& params_;
  Padded values_, noise_;
  int wide_;  ///< Width of the tile with a patch radius on both sides.
  std::vector<Real> pixel_, row_sum_, weight_;
  std::vector<double> sum_, total_;
};

bool has_noise(const Image& noise, const Rect& tile) {
  for (int c = 0; c < noise.channels(); ++c)
    for (int y = tile.y0; y < tile.y1; ++y) {
      const Real* row = noise.row(c, y);
      if (std::any_of(row + tile.x0, row + tile.x1, [](Real v) { return v > 0; })) return true;
    }
  return false;
}

}  // namespace

std::array<Image, 2> prefilter(const std::array<Image, 2>& halves, const Image& variance, const PrefilterParams& params,
                               Progress& progress, const Image& mask) {
  constexpr int tile_side = 64;  // the sums and distances of a tile stay in the second-level cache
  const Image noise = widened_variance(variance);
  std::array<Image, 2> out = halves;
  auto tiles = aligned_blocks(variance.bounds(), tile_side);
  const auto noise_free = [&](const Rect& tile) { return !has_noise(noise, tile); };
  tiles.erase(std::remove_if(tiles.begin(), tiles.end(), noise_free), tiles.end());
  parallel_for(2 * tiles.size(), progress, [&](std::size_t i) {
    const std::size_t h = i % 2;
    TileFilter(halves[h], halves[1 - h], noise, mask, tiles[i / 2], params).run(out[h]);
  });
  return out;
}

}  // namespace polyrecon
