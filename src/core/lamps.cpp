#include "core/lamps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/color_layout.h"
#include "core/halves.h"
#include "core/mask.h"
#include "core/mean.h"
#include "core/parallel.h"
#include "core/real.h"
#include "core/rect.h"
#include "core/relmse.h"
#include "core/repair.h"

namespace polyrecon {
namespace {

constexpr int block_side = 8;           // pixels
constexpr int block_radius = 2;         // blocks around that of a pixel: more than the usual window
constexpr double quarter = 0.25;        // of these blocks are darker than B
constexpr Real over_surroundings = 50;  // the least over B that is worth it: at 20, windows still follow the edge
constexpr Real far_over_surroundings = 300;
constexpr Real far_over_picture = 100;  // a face in candlelight is far over the dark around it, and noisy
constexpr double nearly_all = 0.9;      // of the blocks are darker than P
constexpr Real over_surroundings_at_rim = 8;
constexpr Real equal_within = Real(0.01);
constexpr int least_equal_neighbours = 4;
constexpr double large_share = 0.05;  // of the energy: spread over all pixels, it would change them visibly
constexpr int rim_width = 2;          // pixels that usual pixel filters spread an edge over

/// The brightest primary of each pixel; 0 outside the mask.
Image brightness_of(const Image& color, const Image& rendered) {
  Image out(color.width(), color.height(), 1);
  for_rows(out.height(), [&](int y) {
    for (int x = 0; x < out.width(); ++x)
      for (int c = 0; c < color.channels(); ++c)
        if (in_mask(rendered, out.index(x, y))) out.at(x, y, 0) = std::max(out.at(x, y, 0), color.at(x, y, c));
  });
  return out;
}

/// The mean brightness of each block; -1 where none of its pixels is in the mask.
Image block_means(const Image& brightness, const Image& rendered) {
  const auto blocks = [](int pixels) { return (pixels + block_side - 1) / block_side; };
  Image means(blocks(brightness.width()), blocks(brightness.height()), 1);
  for_rows(means.height(), [&](int v) {
    for (int u = 0; u < means.width(); ++u) {
      const Rect block{u * block_side, v * block_side, (u + 1) * block_side, (v + 1) * block_side};
      const Rect area = intersect(block, brightness.bounds());
      double sum = 0, count = 0;
      for (int y = area.y0; y < area.y1; ++y)
        for (int x = area.x0; x < area.x1; ++x) {
          if (!in_mask(rendered, brightness.index(x, y))) continue;
          sum += static_cast<double>(brightness.at(x, y, 0));
          ++count;
        }
      means.at(u, v, 0) = count > 0 ? static_cast<Real>(sum / count) : Real(-1);
    }
  });
  return means;
}

/// The mean below which this share of the blocks of an area lies; 0 where no block is in the mask.
Real level_of(const Image& means, const Rect& area, double share) {
  std::vector<Real> inside;
  for (int v = area.y0; v < area.y1; ++v)
    for (int u = area.x0; u < area.x1; ++u)
      if (means.at(u, v, 0) >= 0) inside.push_back(means.at(u, v, 0));
  if (inside.empty()) return 0;
  const auto chosen = inside.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(inside.size()));
  std::nth_element(inside.begin(), chosen, inside.end());
  return *chosen;
}

/// What the brightness of pixels is compared with.
struct Levels {
  Image surroundings;  ///< B of each block.
  Real picture;        ///< P.

  Real around(int x, int y) const { return surroundings.at(x / block_side, y / block_side, 0); }
};

Levels levels_of(const Image& brightness, const Image& rendered) {
  const Image means = block_means(brightness, rendered);
  Levels levels{Image(means.width(), means.height(), 1), level_of(means, means.bounds(), nearly_all)};
  for_rows(means.height(), [&](int v) {
    for (int u = 0; u < means.width(); ++u)
      levels.surroundings.at(u, v, 0) =
          level_of(means, intersect(grow({u, v, u + 1, v + 1}, block_radius), means.bounds()), quarter);
  });
  return levels;
}

/// The median of the 3 x 3 pixels around one, those at the border of the image fewer; of an even number the lower one.
Real median_around(const Image& image, int x, int y) {
  std::array<Real, 9> values{};
  const Rect area = intersect(grow({x, y, x + 1, y + 1}, 1), image.bounds());
  auto end = values.begin();
  for (int v = area.y0; v < area.y1; ++v)
    for (int u = area.x0; u < area.x1; ++u) *end++ = image.at(u, v, 0);
  const auto middle = values.begin() + (end - values.begin() - 1) / 2;
  std::nth_element(values.begin(), middle, end);
  return *middle;
}

int equal_neighbours(const Image& image, int x, int y) {
  const Rect area = intersect(grow({x, y, x + 1, y + 1}, 1), image.bounds());
  const Real value = image.at(x, y, 0);
  int count = -1;  // the pixel itself
  for (int v = area.y0; v < area.y1; ++v)
    for (int u = area.x0; u < area.x1; ++u) count += std::abs(image.at(u, v, 0) - value) <= equal_within * value;
  return count;
}

bool shows_lamp(const Image& brightness, const Levels& levels, double energy, int x, int y) {
  const Real around = levels.around(x, y), value = brightness.at(x, y, 0);
  if (!(around > 0) || !(value > over_surroundings * around)) return false;
  const auto is_far = [&](Real v) {
    return v > far_over_surroundings * around && v > far_over_picture * levels.picture;
  };
  const auto own = static_cast<double>(value);
  if (is_far(value) && own > large_share * (energy - own)) return true;
  const Real median = median_around(brightness, x, y);
  return is_far(median) ||
         (median > over_surroundings * around && equal_neighbours(brightness, x, y) >= least_equal_neighbours);
}

/// Adds the pixels next to those of lamps that are brighter than their surroundings.
void add_rim(const Image& brightness, const Levels& levels, Image& others) {
  const Image before = others;
  for_rows(others.height(), [&](int y) {
    for (int x = 0; x < others.width(); ++x) {
      if (!(brightness.at(x, y, 0) > over_surroundings_at_rim * levels.around(x, y))) continue;
      const Rect area = intersect(grow({x, y, x + 1, y + 1}, 1), others.bounds());
      for (int v = area.y0; v < area.y1; ++v)
        for (int u = area.x0; u < area.x1; ++u)
          if (before.at(u, v, 0) == 0) others.at(x, y, 0) = 0;
    }
  });
}

Image others_than_lamps(const Image& brightness, const Image& rendered) {
  const Levels levels = levels_of(brightness, rendered);
  const double energy = ordered_sum(static_cast<std::size_t>(brightness.height()), [&](std::size_t y) {
    double row = 0;
    for (int x = 0; x < brightness.width(); ++x) row += static_cast<double>(brightness.at(x, static_cast<int>(y), 0));
    return row;
  });
  Image others(brightness.width(), brightness.height(), 1, Real(1));
  for_rows(others.height(), [&](int y) {
    for (int x = 0; x < others.width(); ++x)
      if (shows_lamp(brightness, levels, energy, x, y)) others.at(x, y, 0) = 0;
  });
  for (int i = 0; i < rim_width; ++i) add_rim(brightness, levels, others);
  return others;
}

/// known_variance of a pass at these pixels; empty where its noise is not known.
Image variance_there(const Pass& pass, const std::vector<std::size_t>& pixels) {
  if (!pass.noise_is_known()) return {};
  Image out(static_cast<int>(pixels.size()), 1, pass.mean.channels());
  for (int c = 0; c < out.channels(); ++c)
    for (std::size_t k = 0; k < pixels.size(); ++k) out.plane(c)[k] = storable(known_variance(pass, c, pixels[k]));
  return out;
}

}  // namespace

Lamps find_lamps(const Frame& frame, const Image& rendered) {
  Lamps lamps;
  const auto repaired = [](Image image) {
    repair_nonfinite(image, repair_depth);
    return image;
  };
  lamps.others = others_than_lamps(brightness_of(repaired(frame.beauty.mean), rendered), rendered);
  for (std::size_t i = 0; i < lamps.others.pixels(); ++i)
    if (!in_mask(lamps.others, i)) lamps.pixels.push_back(i);
  if (lamps.pixels.empty() || lamps.pixels.size() == lamps.others.pixels()) return {};
  const auto keep = [&](const Image& color) {
    Image values(static_cast<int>(lamps.pixels.size()), 1, color.channels());
    for (int c = 0; c < color.channels(); ++c)
      for (std::size_t k = 0; k < lamps.pixels.size(); ++k) values.plane(c)[k] = color.plane(c)[lamps.pixels[k]];
    lamps.layers.push_back(std::move(values));
  };
  keep(repaired(frame.beauty.mean));
  lamps.variance = variance_there(frame.beauty, lamps.pixels);
  for (const Pass& aov : frame.aovs) keep(repaired(aov.mean));
  return lamps;
}

void put_lamps(const Lamps& lamps, const Frame& frame, Image& image) {
  const ColorLayout layout(image.channels());
  for (std::size_t k = 0; k < lamps.pixels.size(); ++k) {
    const std::size_t i = lamps.pixels[k];
    for (int layer = 0; layer < layout.layers(); ++layer)
      for (int c = 0; c < ColorLayout::primaries; ++c)
        image.plane(ColorLayout::first_channel(layer) + c)[i] =
            lamps.layers[static_cast<std::size_t>(layer)].plane(c)[k];
    if (layout.has_alpha()) image.plane(layout.alpha_channel())[i] = frame.alpha.plane(0)[i];
  }
}

void put_errors(const Lamps& lamps, const Image& image, ErrorMap& error) {
  if (lamps.variance.empty()) return;
  for (std::size_t k = 0; k < lamps.pixels.size(); ++k) {
    const std::size_t i = lamps.pixels[k];
    double relative = 0;
    for (int c = 0; c < ColorLayout::primaries; ++c) {
      error.mse.plane(c)[i] = lamps.variance.plane(c)[k];
      relative += static_cast<double>(lamps.variance.plane(c)[k]) /
                  relmse_denominator(static_cast<double>(image.plane(c)[i])) / ColorLayout::primaries;
    }
    for (Image* part : {&error.relative_mse, &error.relative_variance, &error.relative_noise})
      part->plane(0)[i] = storable(relative);
    if (!error.prior_share.empty()) error.prior_share.plane(0)[i] = 0;
  }
  error.mean_relative_mse = mean_of(error.relative_mse);
}

}  // namespace polyrecon
