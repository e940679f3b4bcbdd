#include "outliers/remove.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/color_layout.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/rect.h"

namespace polyrecon {
namespace {

double brightness(const Image& color, std::size_t i) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += static_cast<double>(color.plane(c)[i]);
  return sum / 3;
}

/// The outliers of one half.
struct Replacement {
  std::vector<std::ptrdiff_t> source;  ///< Index of the pixel that replaces each pixel; -1 where it is no outlier.
  std::vector<int> count_above;        ///< Summed-area table of outliers, (width + 1) x (height + 1).
};

/// Whether fewer than three pixels of the half around (x, y) are as bright as it. A cheap test that nearly all pixels
/// fail.
bool stands_out(const Image& half, int x, int y, int radius) {
  const double value = brightness(half, half.index(x, y));
  const Rect around = intersect(grow({x, y, x + 1, y + 1}, radius), half.bounds());
  int as_bright = -1;  // not counting the pixel itself
  for (int v = around.y0; v < around.y1; ++v)
    for (int u = around.x0; u < around.x1; ++u)
      if (brightness(half, half.index(u, v)) >= value && ++as_bright == 3) return false;
  return true;
}

std::ptrdiff_t neighbour_of_median(std::vector<std::pair<double, std::ptrdiff_t>>& neighbours) {
  const auto middle = neighbours.begin() + static_cast<std::ptrdiff_t>(neighbours.size() / 2);
  std::nth_element(neighbours.begin(), middle, neighbours.end());
  return middle->second;
}

/// Whether the noise variance of a pixel allows its excess, so that the pixel cannot be trusted.
bool unreliable(const HalfPair& pair, std::size_t center, double excess, const PairNoise& known,
                const OutlierParams& p) {
  if (!known.variance_is_measured) return true;
  double variance = 0;
  for (int c = 0; c < 3; ++c) variance += static_cast<double>(pair.variance.plane(c)[center]) / 3;
  return excess * excess < p.reliability * p.reliability * variance;
}

/// The first test of remove_outliers: returns the neighbour of median brightness if the pixel of half h is far brighter
/// than the pixels of both halves around it, else -1.
std::ptrdiff_t against_neighbours(const HalfPair& pair, std::size_t h, int x, int y, const PairNoise& known,
                                  const OutlierParams& p) {
  const Image &half = pair.color[h], &other = pair.color[1 - h];
  if (!stands_out(half, x, y, p.neighbourhood)) return -1;
  const std::size_t center = half.index(x, y);
  const double value = brightness(half, center);
  const Rect around = intersect(grow({x, y, x + 1, y + 1}, p.neighbourhood), half.bounds());
  std::vector<double> surroundings;
  std::vector<std::pair<double, std::ptrdiff_t>> neighbours;
  for (int v = around.y0; v < around.y1; ++v)
    for (int u = around.x0; u < around.x1; ++u) {
      const std::size_t i = half.index(u, v);
      if (i != center || known.independent_halves) surroundings.push_back(brightness(other, i));
      if (i == center) continue;
      surroundings.push_back(brightness(half, i));
      neighbours.emplace_back(surroundings.back(), static_cast<std::ptrdiff_t>(i));
    }
  if (neighbours.size() < 3) return -1;
  // The third brightest, so that one more spike nearby, in either half, does not hide this one.
  const std::size_t third = surroundings.size() - 3;
  std::nth_element(surroundings.begin(), surroundings.begin() + static_cast<std::ptrdiff_t>(third), surroundings.end());
  const double top = surroundings[third];
  if (!(value > top)) return -1;
  const auto middle = surroundings.begin() + static_cast<std::ptrdiff_t>(surroundings.size() / 2);
  std::nth_element(surroundings.begin(), middle, surroundings.end());
  const double median = *middle;
  const double excess = value - median;
  const double height = known.independent_halves ? p.height : 2 * p.height;
  if (!(excess > height * (top - median)) || !unreliable(pair, center, excess, known, p)) return -1;
  return neighbour_of_median(neighbours);
}

/// Whether fewer than three of the pixels around differ between the halves by excess / height or more. A cheap test
/// that nearly all pixels fail.
bool stands_out_of_differences(const Image& half, const Image& other, const Rect& around, std::size_t center,
                               double excess, double height) {
  int as_large = 0;
  for (int v = around.y0; v < around.y1; ++v)
    for (int u = around.x0; u < around.x1; ++u) {
      const std::size_t i = half.index(u, v);
      if (i == center || height * std::abs(brightness(half, i) - brightness(other, i)) < excess) continue;
      if (++as_large == 3) return false;
    }
  return true;
}

/// The third largest difference between the halves around a pixel; infinite where there are fewer than three pixels.
double third_difference(const Image& half, const Image& other, const Rect& around, std::size_t center) {
  std::array<double, 3> largest;
  largest.fill(std::numeric_limits<double>::infinity());
  std::size_t count = 0;
  for (int v = around.y0; v < around.y1; ++v)
    for (int u = around.x0; u < around.x1; ++u) {
      const std::size_t i = half.index(u, v);
      if (i == center) continue;
      double difference = std::abs(brightness(half, i) - brightness(other, i));
      if (count < 3) {
        largest[count++] = difference;
        if (count == 3) std::sort(largest.begin(), largest.end(), std::greater<>());
        continue;
      }
      for (double& l : largest)
        if (difference > l) std::swap(difference, l);
    }
  return largest[2];
}

/// The second test of remove_outliers: if the pixel of half h is far brighter than that of the other half and the
/// halves differ much less around it, returns the neighbour of median brightness among the five that are most alike in
/// the other half. -1 if the pixel is no outlier, or if all neighbours differ so much in the other half that a
/// replacement might be wrong by more than a third of the excess.
std::ptrdiff_t against_other_half(const HalfPair& pair, std::size_t h, int x, int y, const PairNoise& known,
                                  const OutlierParams& p) {
  const Image &half = pair.color[h], &other = pair.color[1 - h];
  const std::size_t center = half.index(x, y);
  const double value_in_other = brightness(other, center), excess = brightness(half, center) - value_in_other;
  if (!(excess > 0) || !unreliable(pair, center, excess, known, p)) return -1;
  const Rect around = intersect(grow({x, y, x + 1, y + 1}, p.neighbourhood), half.bounds());
  if (!stands_out_of_differences(half, other, around, center, excess, p.height_over_other_half)) return -1;
  const double third = third_difference(half, other, around, center);
  if (!(excess > p.height_over_other_half * third)) return -1;
  std::vector<std::pair<double, std::ptrdiff_t>> alike, neighbours;
  for (int v = around.y0; v < around.y1; ++v)
    for (int u = around.x0; u < around.x1; ++u) {
      const std::size_t i = half.index(u, v);
      const double difference = std::abs(brightness(other, i) - value_in_other);
      const bool spike = std::abs(brightness(half, i) - brightness(other, i)) > third;
      if (i != center && !spike && 3 * difference < excess)
        alike.emplace_back(difference, static_cast<std::ptrdiff_t>(i));
    }
  if (alike.empty()) return -1;
  std::sort(alike.begin(), alike.end());
  alike.resize(std::min(alike.size(), std::size_t{5}));
  for (const auto& [difference, i] : alike) neighbours.emplace_back(brightness(half, static_cast<std::size_t>(i)), i);
  return neighbour_of_median(neighbours);
}

/// Index of the pixel that replaces pixel (x, y) of half h if that is an outlier, else -1.
std::ptrdiff_t replacement_of(const HalfPair& pair, std::size_t h, int x, int y, const PairNoise& known,
                              const OutlierParams& p) {
  if (!in_mask(pair.sampled, pair.variance.index(x, y))) return -1;
  const std::ptrdiff_t neighbour = against_neighbours(pair, h, x, y, known, p);
  return neighbour >= 0 || !known.independent_halves ? neighbour : against_other_half(pair, h, x, y, known, p);
}

Replacement find(const HalfPair& pair, std::size_t h, const PairNoise& known, const OutlierParams& p,
                 Progress& progress) {
  const int width = pair.width(), height = pair.height();
  Replacement out;
  out.source.assign(pair.variance.pixels(), -1);
  parallel_for(static_cast<std::size_t>(height), progress, [&](std::size_t y) {
    for (int x = 0; x < width; ++x)
      out.source[pair.variance.index(x, static_cast<int>(y))] =
          replacement_of(pair, h, x, static_cast<int>(y), known, p);
  });
  const auto row = static_cast<std::size_t>(width) + 1;
  out.count_above.assign(row * (static_cast<std::size_t>(height) + 1), 0);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x)
      out.count_above[(y + 1) * row + x + 1] = (out.source[y * static_cast<std::size_t>(width) + x] >= 0) +
                                               out.count_above[y * row + x + 1] + out.count_above[(y + 1) * row + x] -
                                               out.count_above[y * row + x];
  return out;
}

/// Whether outliers are so rare around a pixel that they are noise; where they are common they are the scene's energy.
bool rare(const Replacement& found, int width, int height, int x, int y, const OutlierParams& p) {
  const Rect r = intersect(grow({x, y, x + 1, y + 1}, p.density_radius), {0, 0, width, height});
  const auto sum = [&](int u, int v) {
    return found
        .count_above[static_cast<std::size_t>(v) * (static_cast<std::size_t>(width) + 1) + static_cast<std::size_t>(u)];
  };
  const int count = sum(r.x1, r.y1) - sum(r.x0, r.y1) - sum(r.x1, r.y0) + sum(r.x0, r.y0);
  return count <= 1 + p.density * static_cast<double>(r.area());
}

}  // namespace

std::vector<Outlier> remove_outliers(HalfPair& pair, const PairNoise& known, const OutlierParams& params,
                                     Progress& progress) {
  const int width = pair.width(), height = pair.height();
  const int channels = ColorLayout(pair.color[0].channels()).layer_channels();
  const std::array<Replacement, 2> found{find(pair, 0, known, params, progress),
                                         find(pair, 1, known, params, progress)};
  // Replacements are read from copies of the input, as an outlier may be next to another.
  const std::array<Image, 2> color = pair.color;
  const Image variance = pair.variance;
  std::vector<Outlier> outliers;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t h = 0; h < 2; ++h) {
        const std::size_t i = pair.variance.index(x, y);
        if (found[h].source[i] < 0 || !rare(found[h], width, height, x, y, params)) continue;
        const auto from = static_cast<std::size_t>(found[h].source[i]);
        Outlier outlier{x, y, {}};
        for (int c = 0; c < channels; ++c) {
          const Real taken = color[h].plane(c)[i] - color[h].plane(c)[from];
          pair.color[h].plane(c)[i] = color[h].plane(c)[from];
          outlier.energy.push_back(0.5 * static_cast<double>(taken));
        }
        for (int c = 0; c < 3; ++c) pair.variance.plane(c)[i] = variance.plane(c)[from];
        outliers.push_back(std::move(outlier));
      }
  return outliers;
}

}  // namespace polyrecon
