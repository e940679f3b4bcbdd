#include "blend/noise_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "blend/select.h"
#include "core/color_layout.h"
#include "core/parallel.h"
#include "core/rect.h"

namespace polyrecon {
namespace {

constexpr int radius = 3;
constexpr Real deviations = 5;

/// Applies reduce(first, end) to the values of a row within `radius` of each pixel.
template <typename Reduce>
Image along_rows(const Image& in, const Reduce& reduce) {
  Image out(in.width(), in.height(), in.channels());
  for_rows(in.height(), [&](int y) {
    for (int c = 0; c < in.channels(); ++c) {
      const Real* row = in.row(c, y);
      for (int x = 0; x < in.width(); ++x)
        out.at(x, y, c) = reduce(row + std::max(x - radius, 0), row + std::min(x + radius + 1, in.width()));
    }
  });
  return out;
}

/// The same along columns. It works row by row: combine(result so far, next value), then finish(result, number of
/// values).
template <typename Combine, typename Finish>
Image along_columns(const Image& in, const Combine& combine, const Finish& finish) {
  Image out(in.width(), in.height(), in.channels());
  for_rows(in.height(), [&](int y) {
    const int first = std::max(y - radius, 0), end = std::min(y + radius + 1, in.height());
    for (int c = 0; c < in.channels(); ++c) {
      Real* row = out.row(c, y);
      std::copy_n(in.row(c, first), in.width(), row);
      for (int v = first + 1; v < end; ++v) std::transform(row, row + in.width(), in.row(c, v), row, combine);
      std::transform(row, row + in.width(), row, [&](Real value) { return finish(value, end - first); });
    }
  });
  return out;
}

Image standard_deviation(const Image& variance) {
  Image out = variance;
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < out.channels(); ++c)
      std::transform(out.row(c, y), out.row(c, y) + out.width(), out.row(c, y), [](Real v) { return std::sqrt(v); });
  });
  return out;
}

/// Means over 7 x 7 pixels, at the border over fewer.
Image mean_around(const Image& in) {
  const Image rows = along_rows(in, [](const Real* first, const Real* end) {
    Real sum = 0;
    for (const Real* p = first; p < end; ++p) sum += *p;
    return sum / static_cast<Real>(end - first);
  });
  return along_columns(
      rows, [](Real sum, Real v) { return sum + v; }, [](Real sum, int n) { return sum / static_cast<Real>(n); });
}

Image least_around(const Image& in) {
  const Image rows = along_rows(in, [](const Real* first, const Real* end) { return *std::min_element(first, end); });
  return along_columns(
      rows, [](Real least, Real v) { return std::min(least, v); }, [](Real least, int) { return least; });
}

double mean(const std::array<Image, 2>& halves, int x, int y, int c) {
  return 0.5 * (static_cast<double>(halves[0].at(x, y, c)) + static_cast<double>(halves[1].at(x, y, c)));
}

/// The part of the distance of a pixel's result from its input that is within the bound.
double part_within(const HalfPair& pair, const Image& bound, const Candidate& result, int x, int y, int color) {
  const double distance = std::abs(mean(result.half, x, y, color) - mean(pair.color, x, y, color));
  const auto most = static_cast<double>(bound.at(x, y, color));
  return distance > most ? most / distance : 1;
}

/// How strongly a colour is bound: 1, or less where it would lose more than max_lost of its energy.
double strength_of(const HalfPair& pair, const Image& bound, const Candidate& result, double max_lost, int color) {
  const auto sum = [&](const auto& term) {
    return ordered_sum(static_cast<std::size_t>(pair.height()), [&](std::size_t y) {
      double row = 0;
      for (int x = 0; x < pair.width(); ++x) row += term(x, static_cast<int>(y));
      return row;
    });
  };
  const double energy = sum([&](int x, int y) { return std::max(mean(pair.color, x, y, color), 0.0); });
  const double lost = std::abs(sum([&](int x, int y) {
    return (1 - part_within(pair, bound, result, x, y, color)) *
           (mean(result.half, x, y, color) - mean(pair.color, x, y, color));
  }));
  return lost > max_lost * energy ? max_lost * energy / lost : 1;
}

/// Binds one pixel, adds the energy that it lost to `energy`, and returns whether it was changed.
bool bind_pixel(const HalfPair& pair, const Image& bound, const std::array<double, 3>& strength, int x, int y,
                Candidate& result, std::vector<double>& energy) {
  const ColorLayout layout(pair.color[0].channels());
  bool changed = false;
  for (std::size_t color = 0; color < 3; ++color) {
    const auto first = static_cast<int>(color);
    const double part = 1 - strength[color] * (1 - part_within(pair, bound, result, x, y, first));
    if (part == 1) continue;
    changed = true;
    for (int layer = 0; layer < layout.layers(); ++layer) {
      const int c = ColorLayout::channel(layer, first);
      const double noisy = mean(pair.color, x, y, c), before = mean(result.half, x, y, c);
      for (Image& half : result.half)
        half.at(x, y, c) = static_cast<Real>(noisy + part * (static_cast<double>(half.at(x, y, c)) - noisy));
      energy[static_cast<std::size_t>(c)] += before - mean(result.half, x, y, c);
    }
    result.squared_bias.at(x, y, first) *= static_cast<Real>(part * part);
  }
  return changed;
}

}  // namespace

Image noise_bound(const Image& variance) {
  const Image sigma = standard_deviation(variance);
  Image bound = least_around(mean_around(sigma));
  for_rows(bound.height(), [&](int y) {
    for (int c = 0; c < bound.channels(); ++c)
      std::transform(bound.row(c, y), bound.row(c, y) + bound.width(), sigma.row(c, y), bound.row(c, y),
                     [](Real around, Real pixel) { return deviations * std::max(around, pixel); });
  });
  return bound;
}

BoundEnergy bind_to_noise(const HalfPair& pair, const Image& bound, double max_lost, Candidate& result) {
  std::array<double, 3> strength{};
  for (int color = 0; color < 3; ++color)
    strength[static_cast<std::size_t>(color)] = strength_of(pair, bound, result, max_lost, color);
  const auto colors = static_cast<std::size_t>(ColorLayout(pair.color[0].channels()).layer_channels());
  std::vector<BoundEnergy> of_row(static_cast<std::size_t>(pair.height()), {0, std::vector<double>(colors, 0.0)});
  for_rows(pair.height(), [&](int y) {
    BoundEnergy& row = of_row[static_cast<std::size_t>(y)];
    for (int x = 0; x < pair.width(); ++x) row.pixels += bind_pixel(pair, bound, strength, x, y, result, row.energy);
  });
  BoundEnergy all{0, std::vector<double>(colors, 0.0)};
  for (const BoundEnergy& row : of_row) {
    all.pixels += row.pixels;
    for (std::size_t c = 0; c < colors; ++c) all.energy[c] += row.energy[c];
  }
  return all;
}

}  // namespace polyrecon
