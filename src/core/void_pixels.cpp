#include "core/void_pixels.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "core/mask.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "core/repair.h"

namespace polyrecon {
namespace {

constexpr int window_radius = 10;          // pixels; of the usual windows
constexpr double most_speckles = 0.02;     // of the pixels within that radius; a straight border has none
constexpr Real opaque_from = Real(0.999);  // alpha
constexpr int neighbours_of_speckle = 7;   // of 8 that are unlike it; a line one pixel wide has 6

using Mask = std::vector<unsigned char>;

/// Whether all channels are 0. Without light a value that is not finite counts as 0 too.
bool is_black(const Image& image, std::size_t i, bool without_light) {
  for (int c = 0; c < image.channels(); ++c) {
    const Real v = image.plane(c)[i];
    if (v != 0 && !(without_light && !usable(v))) return false;
  }
  return true;
}

/// Whether a feature shows nothing at a pixel.
bool is_nothing(const Feature& feature, double sky, std::size_t i) {
  const Image& mean = feature.pass.mean;
  const EmptyValue empty = info_of(feature.role).empty;
  for (int c = 0; c < mean.channels(); ++c) {
    const Real v = mean.plane(c)[i];
    if (v == 0 || !usable(v)) continue;
    if (empty == EmptyValue::ZeroOrSky && static_cast<double>(v) >= sky) continue;
    if (empty == EmptyValue::ZeroOrOne && v == 1) continue;
    return false;
  }
  return true;
}

/// The pixels in which all passes are 0; empty if no pass shows it.
Mask empty_pixels(const Frame& frame) {
  const bool telling = std::any_of(frame.features.begin(), frame.features.end(),
                                   [](const Feature& f) { return info_of(f.role).empty != EmptyValue::ZeroOrOne; });
  if (frame.alpha.empty() && !telling) return {};
  Mask out(frame.beauty.mean.pixels(), 0);
  for_rows(frame.height(), [&](int y) {
    const std::size_t first = frame.beauty.mean.index(0, y);
    for (std::size_t i = first; i < first + static_cast<std::size_t>(frame.width()); ++i) {
      const bool transparent = !frame.alpha.empty() && frame.alpha.plane(0)[i] == 0;
      if (!is_black(frame.beauty.mean, i, transparent) || (!frame.alpha.empty() && !transparent)) continue;
      out[i] = std::all_of(frame.aovs.begin(), frame.aovs.end(),
                           [&](const Pass& aov) { return is_black(aov.mean, i, transparent); }) &&
               std::all_of(frame.features.begin(), frame.features.end(),
                           [&](const Feature& f) { return is_nothing(f, frame.sky_depth, i); });
    }
  });
  return out;
}

/// Whether nearly all pixels around (x, y) are unlike it.
bool is_speckle(const Mask& mask, const Rect& bounds, int x, int y) {
  const auto at = [&](int u, int v) {
    return mask[static_cast<std::size_t>(v) * static_cast<std::size_t>(bounds.x1) + static_cast<std::size_t>(u)];
  };
  const Rect around = intersect(grow({x, y, x + 1, y + 1}, 1), bounds);
  int unlike = 0;
  for (int v = around.y0; v < around.y1; ++v)
    for (int u = around.x0; u < around.x1; ++u) unlike += at(u, v) != at(x, y);
  return 8 * unlike >= neighbours_of_speckle * (static_cast<int>(around.area()) - 1) && unlike > 0;
}

/// Counts marked pixels around pixels.
class Counts {
 public:
  /// is_marked(x, y) for all pixels of bounds.
  template <typename IsMarked>
  Counts(const Rect& bounds, const IsMarked& is_marked)
      : bounds_(bounds),
        row_(static_cast<std::size_t>(bounds.x1) + 1),
        sums_(row_ * (static_cast<std::size_t>(bounds.y1) + 1), 0) {
    for_rows(bounds.y1, [&](int y) {
      int* out = sums_.data() + (static_cast<std::size_t>(y) + 1) * row_;
      for (int x = 0; x < bounds.x1; ++x) out[x + 1] = out[x] + (is_marked(x, y) ? 1 : 0);
    });
    for (std::size_t i = row_; i < sums_.size(); ++i) sums_[i] += sums_[i - row_];
  }

  /// The share of marked pixels within `radius` of (x, y).
  double around(int x, int y, int radius) const {
    const Rect r = intersect(grow({x, y, x + 1, y + 1}, radius), bounds_);
    return (sum(r.x1, r.y1) - sum(r.x0, r.y1) - sum(r.x1, r.y0) + sum(r.x0, r.y0)) / static_cast<double>(r.area());
  }

 private:
  int sum(int x, int y) const { return sums_[static_cast<std::size_t>(y) * row_ + static_cast<std::size_t>(x)]; }

  Rect bounds_;
  std::size_t row_;
  std::vector<int> sums_;
};

/// The mask without pixels that are in no square of 2 x 2 of its pixels: what a few samples missed by chance.
Mask without_lone_pixels(const Rect& bounds, const Mask& mask) {
  const auto width = static_cast<std::size_t>(bounds.x1);
  Mask out(mask.size(), 0);
  for (int y = 0; y + 1 < bounds.y1; ++y)
    for (std::size_t x = 0; x + 1 < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (mask[i] && mask[i + 1] && mask[i + width] && mask[i + width + 1])
        out[i] = out[i + 1] = out[i + width] = out[i + width + 1] = 1;
    }
  return out;
}

/// Takes the pixels out of the mask around which it is mixed with others.
void leave_mixtures(const Rect& bounds, Mask& mask) {
  const Counts speckles(bounds, [&](int x, int y) { return is_speckle(mask, bounds, x, y); });
  for_rows(bounds.y1, [&](int y) {
    for (int x = 0; x < bounds.x1; ++x)
      if (speckles.around(x, y, window_radius) > most_speckles)
        mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(bounds.x1) + static_cast<std::size_t>(x)] = 0;
  });
}

void hide_void(const Image& rendered, Pass& pass) {
  for (Image* image : {&pass.mean, &pass.variance, &pass.half_a, &pass.half_b})
    *image = outside_set_to(std::numeric_limits<Real>::quiet_NaN(), rendered, std::move(*image));
}

}  // namespace

Image rendered_mask(const Frame& frame) {
  Mask empty = empty_pixels(frame);
  if (std::find(empty.begin(), empty.end(), 1) == empty.end()) return {};
  leave_mixtures(frame.beauty.mean.bounds(), empty);
  empty = without_lone_pixels(frame.beauty.mean.bounds(), empty);
  const auto voids = static_cast<std::size_t>(std::count(empty.begin(), empty.end(), 1));
  if (voids == 0 || voids == empty.size()) return {};
  Image rendered(frame.width(), frame.height(), 1);
  std::transform(empty.begin(), empty.end(), rendered.plane(0), [](unsigned char e) { return e ? Real(0) : Real(1); });
  return rendered;
}

Image sampled_mask(const Image& rendered, const Frame& frame) {
  if (rendered.empty()) return {};
  const Rect bounds = rendered.bounds();
  const Counts voids(bounds, [&](int x, int y) { return !in_mask(rendered, rendered.index(x, y)); });
  const Counts soft(bounds, [&](int x, int y) {
    const std::size_t i = rendered.index(x, y);
    const bool opaque = !frame.alpha.empty() && frame.alpha.plane(0)[i] >= opaque_from;
    return in_mask(rendered, i) && !opaque && voids.around(x, y, 1) > 0;
  });
  Image sampled = rendered;
  for_rows(bounds.y1, [&](int y) {
    for (int x = 0; x < bounds.x1; ++x)
      if (soft.around(x, y, window_radius) > 0) sampled.at(x, y, 0) = 1;
  });
  return mask_pixels(sampled, sampled.pixels()) == sampled.pixels() ? Image() : sampled;
}

void hide_void(const Image& rendered, Frame& frame) {
  if (rendered.empty()) return;
  hide_void(rendered, frame.beauty);
  for (Pass& aov : frame.aovs) hide_void(rendered, aov);
  for (Feature& feature : frame.features) hide_void(rendered, feature.pass);
}

void empty_void(const Image& rendered, HalfPair& pair, Candidate& result) {
  if (rendered.empty()) return;
  for (Image* image : {&pair.color[0], &pair.color[1], &pair.variance, &result.half[0], &result.half[1],
                       &result.squared_bias, &result.variance, &result.order})
    *image = outside_set_to(0, rendered, std::move(*image));
}

}  // namespace polyrecon
