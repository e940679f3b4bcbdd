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

/// For every pixel `of` (values of one line around it, first and end), along rows.
template <typename Of>
Image along_rows(const Image& in, const Of& of) {
  Image out(in.width(), in.height(), in.channels());
  for_rows(in.height(), [&](int y) {
    for (int c = 0; c < in.channels(); ++c) {
      const Real* row = in.row(c, y);
      for (int x = 0; x < in.width(); ++x)
        out.at(x, y, c) = of(row + std::max(x - radius, 0), row + std::min(x + radius + 1, in.width()));
    }
  });
  return out;
}

/// The same along columns, row by row: `of` takes the result so far and the next value, `last` the number of values.
template <typename Of, typename Last>
Image along_columns(const Image& in, const Of& of, const Last& last) {
  Image out(in.width(), in.height(), in.channels());
  for_rows(in.height(), [&](int y) {
    const int first = std::max(y - radius, 0), end = std::min(y + radius + 1, in.height());
    for (int c = 0; c < in.channels(); ++c) {
      Real* row = out.row(c, y);
      std::copy_n(in.row(c, first), in.width(), row);
      for (int v = first + 1; v < end; ++v) std::transform(row, row + in.width(), in.row(c, v), row, of);
      std::transform(row, row + in.width(), row, [&](Real value) { return last(value, end - first); });
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

/// Means over 7 x 7 pixels, those beyond the border left out.
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

/// What is left of the distance of a pixel's result from its input.
double part_within(const HalfPair& pair, const Image& reach, const Candidate& result, int x, int y, int color) {
  const double distance = std::abs(mean(result.half, x, y, color) - mean(pair.color, x, y, color));
  const auto most = static_cast<double>(reach.at(x, y, color));
  return distance > most ? most / distance : 1;
}

/// How far a colour is bound: 1, or less where it would lose more than max_lost of its light.
double strength_of(const HalfPair& pair, const Image& reach, const Candidate& result, double max_lost, int color) {
  const auto sum = [&](const auto& term) {
    return ordered_sum(static_cast<std::size_t>(pair.height()), [&](std::size_t y) {
      double row = 0;
      for (int x = 0; x < pair.width(); ++x) row += term(x, static_cast<int>(y));
      return row;
    });
  };
  const double light = sum([&](int x, int y) { return std::max(mean(pair.color, x, y, color), 0.0); });
  const double lost = std::abs(sum([&](int x, int y) {
    return (1 - part_within(pair, reach, result, x, y, color)) *
           (mean(result.half, x, y, color) - mean(pair.color, x, y, color));
  }));
  return lost > max_lost * light ? max_lost * light / lost : 1;
}

/// Adds what the pixel lost to energy; whether it lost anything.
bool bind_pixel(const HalfPair& pair, const Image& reach, const std::array<double, 3>& strength, int x, int y,
                Candidate& result, std::vector<double>& energy) {
  const ColorLayout layout(pair.color[0].channels());
  bool bound = false;
  for (std::size_t color = 0; color < 3; ++color) {
    const auto first = static_cast<int>(color);
    const double part = 1 - strength[color] * (1 - part_within(pair, reach, result, x, y, first));
    if (part == 1) continue;
    bound = true;
    for (int layer = 0; layer < layout.layers(); ++layer) {
      const int c = ColorLayout::channel(layer, first);
      const double noisy = mean(pair.color, x, y, c), before = mean(result.half, x, y, c);
      for (Image& half : result.half)
        half.at(x, y, c) = static_cast<Real>(noisy + part * (static_cast<double>(half.at(x, y, c)) - noisy));
      energy[static_cast<std::size_t>(c)] += before - mean(result.half, x, y, c);
    }
    result.squared_bias.at(x, y, first) *= static_cast<Real>(part * part);
  }
  return bound;
}

}  // namespace

Image noise_reach(const Image& variance) {
  const Image own = standard_deviation(variance);
  Image reach = least_around(mean_around(own));
  for_rows(reach.height(), [&](int y) {
    for (int c = 0; c < reach.channels(); ++c)
      std::transform(reach.row(c, y), reach.row(c, y) + reach.width(), own.row(c, y), reach.row(c, y),
                     [](Real quietest, Real sigma) { return deviations * std::max(quietest, sigma); });
  });
  return reach;
}

BoundEnergy bind_to_noise(const HalfPair& pair, const Image& reach, double max_lost, Candidate& result) {
  std::array<double, 3> strength{};
  for (int color = 0; color < 3; ++color)
    strength[static_cast<std::size_t>(color)] = strength_of(pair, reach, result, max_lost, color);
  const auto colors = static_cast<std::size_t>(ColorLayout(pair.color[0].channels()).layer_channels());
  std::vector<BoundEnergy> of_row(static_cast<std::size_t>(pair.height()), {0, std::vector<double>(colors, 0.0)});
  for_rows(pair.height(), [&](int y) {
    BoundEnergy& row = of_row[static_cast<std::size_t>(y)];
    for (int x = 0; x < pair.width(); ++x) row.pixels += bind_pixel(pair, reach, strength, x, y, result, row.energy);
  });
  BoundEnergy all{0, std::vector<double>(colors, 0.0)};
  for (const BoundEnergy& row : of_row) {
    all.pixels += row.pixels;
    for (std::size_t c = 0; c < colors; ++c) all.energy[c] += row.energy[c];
  }
  return all;
}

}  // namespace polyrecon
