#include "noise/half_correlation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/color_layout.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "noise/filter_correlation.h"

namespace polyrecon {
namespace {

constexpr double half_pi = 1.57079632679489662;
constexpr double least_agreement = 0.02;  // mean product of signs
constexpr double chance = 3;              // standard deviations of that mean, 1 / sqrt(values)
constexpr double least_noisy_values = 1000;

int sign_of_difference(Real a, Real b) { return (a > b ? 1 : 0) - (a < b ? 1 : 0); }

/// 1 or -1: the half that is the larger one; 0 where no half is, or where the pixel is no sample of the picture.
int sign_of_noise(const HalfPair& pair, int x, int y, int c) {
  if (!in_mask(pair.sampled, pair.variance.index(x, y))) return 0;
  return sign_of_difference(pair.color[0].at(x, y, c), pair.color[1].at(x, y, c));
}

/// Sum of term(x, y, c) over the pixels and colours of a pair. The terms are whole numbers, and few.
template <typename Term>
double sum_over_colors(const HalfPair& pair, const Term& term) {
  return ordered_sum(static_cast<std::size_t>(pair.height()), [&](std::size_t row) {
    int sum = 0;
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < pair.width(); ++x) sum += term(x, static_cast<int>(row), c);
    return static_cast<double>(sum);
  });
}

}  // namespace

double correlation_of_halves(const HalfPair& pair) {
  const auto over_pairs = [&](const auto& term) {
    return sum_over_colors(pair, [&](int x, int y, int c) {
      const int here = sign_of_noise(pair, x, y, c);
      return (x + 1 < pair.width() ? term(here * sign_of_noise(pair, x + 1, y, c)) : 0) +
             (y + 1 < pair.height() ? term(here * sign_of_noise(pair, x, y + 1, c)) : 0);
    });
  };
  const double pairs = over_pairs([](int product) { return std::abs(product); });
  if (!(pairs > 0)) return 0;
  const double correlation = std::sin(half_pi * over_pairs([](int product) { return product; }) / pairs);
  return filter_correlation(correlation);
}

bool made_of_halves(const HalfPair& pair, const Image& a, const Image& b) {
  const double noisy =
      sum_over_colors(pair, [&](int x, int y, int c) { return std::abs(sign_of_noise(pair, x, y, c)); });
  if (noisy < least_noisy_values) return true;
  const double agreement = sum_over_colors(pair, [&](int x, int y, int c) {
    return sign_of_noise(pair, x, y, c) * sign_of_difference(a.at(x, y, c), b.at(x, y, c));
  });
  return agreement > least_agreement * noisy + chance * std::sqrt(noisy);
}

}  // namespace polyrecon
