#include "outliers/restore.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/parallel.h"
#include "core/sanitise.h"

namespace polyrecon {
namespace {

/// Sum of term(value) over the usable pixels of a channel.
double sum_of(const Image& image, int channel, const std::function<double(double)>& term) {
  return ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t y) {
    double row = 0;
    const Real* values = image.row(channel, static_cast<int>(y));
    for (int x = 0; x < image.width(); ++x)
      if (usable(values[x])) row += term(static_cast<double>(values[x]));
    return row;
  });
}

/// yhat^2; negative pixels receive nothing.
double share_of(double yhat) { return yhat > 0 ? yhat * yhat : 0; }

double sum_of_shares(const Image& image, int channel) { return sum_of(image, channel, share_of); }

/// Adds energy[c] to channel c = color, color + 3, ..., in proportion to the shares of `color`, whose sum is `shares`.
void give(const std::vector<double>& energy, int color, double shares, Image& image) {
  for_rows(image.height(), [&](int y) {
    std::vector<double> share(static_cast<std::size_t>(image.width()));
    const Real* yhat = image.row(color, y);
    for (int x = 0; x < image.width(); ++x)
      share[static_cast<std::size_t>(x)] = usable(yhat[x]) ? share_of(static_cast<double>(yhat[x])) / shares : 0;
    for (int c = color; c < static_cast<int>(energy.size()); c += 3) {
      Real* out = image.row(c, y);
      for (int x = 0; x < image.width(); ++x)
        out[x] += static_cast<Real>(energy[static_cast<std::size_t>(c)] * share[static_cast<std::size_t>(x)]);
    }
  });
}

}  // namespace

void restore_energy(const std::vector<Outlier>& outliers, Image& image) {
  if (outliers.empty()) return;
  std::vector<double> energy(static_cast<std::size_t>(image.channels() / 3 * 3), 0.0);
  for (const Outlier& outlier : outliers)
    for (std::size_t c = 0; c < energy.size(); ++c) energy[c] += outlier.energy[c];
  for (int color = 0; color < 3; ++color) {
    const double shares = sum_of_shares(image, color);
    if (shares > 0) {
      give(energy, color, shares, image);
      continue;
    }
    for (const Outlier& outlier : outliers)
      for (std::size_t c = static_cast<std::size_t>(color); c < energy.size(); c += 3)
        image.at(outlier.x, outlier.y, static_cast<int>(c)) += static_cast<Real>(outlier.energy[c]);
  }
}

std::vector<double> channel_sums(const Image& image) {
  std::vector<double> sums;
  for (int c = 0; c < image.channels(); ++c) sums.push_back(sum_of(image, c, [](double v) { return v; }));
  return sums;
}

std::array<double, 3> restore_totals(const std::vector<double>& totals, double max_gain, Image& image) {
  const std::vector<double> found = channel_sums(image);
  std::vector<double> missing(totals.size());
  for (std::size_t c = 0; c < totals.size(); ++c) missing[c] = totals[c] - found[c];
  std::array<double, 3> gains{};
  for (int color = 0; color < 3; ++color) {
    const auto c = static_cast<std::size_t>(color);
    const double positive = sum_of(image, color, [](double v) { return std::max(v, 0.0); });
    const double gain = positive > 0 ? missing[c] / positive : 0;
    if (!(std::abs(gain) <= max_gain) || !(positive > 0)) continue;
    gains[c] = gain;
    give(missing, color, sum_of_shares(image, color), image);
  }
  return gains;
}

}  // namespace polyrecon
