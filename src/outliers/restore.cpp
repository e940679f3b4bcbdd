#include "outliers/restore.h"

#include <algorithm>
#include <cmath>

#include "core/color_layout.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "core/repair.h"

namespace polyrecon {
namespace {

/// Largest relative gain of a pixel where the whole image takes part, unless all pixels must gain more.
constexpr double largest_gain = 0.5;
/// Largest relative gain of a pixel from the energy of outliers around it (docs/lab/2026-12-01-noise-of-features.md).
constexpr double most_local_gain = 0.03;

constexpr double below_all_values = 1e-100;  ///< Below every positive value of an image.

double positive_part(Real value) { return usable(value) ? std::max(static_cast<double>(value), 0.0) : 0; }

/// Sum of term(value, index of the pixel) over the usable pixels of a channel.
template <typename Term>
double sum_of(const Image& image, int channel, const Term& term) {
  return ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t y) {
    double row = 0;
    const Real* values = image.row(channel, static_cast<int>(y));
    const std::size_t first = image.index(0, static_cast<int>(y));
    for (std::size_t x = 0; x < static_cast<std::size_t>(image.width()); ++x)
      if (usable(values[x])) row += term(static_cast<double>(values[x]), first + x);
    return row;
  });
}

/// kappa of every pixel. It is computed for the brightness, not per channel, so that one channel and one table of sums
/// suffice.
Image kappa_of(const Image& variance, double noise_free, const Image& image) {
  Image kappa(image.width(), image.height(), 1);
  for_rows(image.height(), [&](int y) {
    for (int x = 0; x < image.width(); ++x) {
      double sigma = 0, yhat = 0;
      for (int c = 0; c < 3; ++c) {
        // Half of the variance of a half is that of the mean.
        sigma += std::sqrt(0.5 * static_cast<double>(variance.at(x, y, c)));
        yhat += positive_part(image.at(x, y, c));
      }
      kappa.at(x, y, 0) = static_cast<Real>(sigma < noise_free * yhat ? sigma / (noise_free * yhat) : 1);
    }
  });
  return kappa;
}

/// kappa yhat^2 of a pixel; 0 for a value that is not positive.
double share_of(Real value, Real kappa) {
  const double yhat = positive_part(value);
  return static_cast<double>(kappa) * yhat * yhat;
}

/// How energy for all pixels of a channel is shared out: kappa yhat min(yhat, limit) / sum of the same.
struct Sharing {
  double limit = 0, sum = 0;  ///< sum is 0 where no pixel is positive.

  double of(Real value, Real kappa) const {
    const double yhat = positive_part(value);
    return static_cast<double>(kappa) * yhat * std::min(yhat, limit) / sum;
  }
};

/// Sums over the pixels below and above a limit.
struct LimitedSums {
  double squares;  ///< Sum of kappa v^2 over the positive values up to the limit.
  double above;    ///< Sum of kappa v over the values above the limit.
};

LimitedSums limited_sums(const Image& image, const Image& kappa, int channel, double limit) {
  const auto k = [&](std::size_t i) { return static_cast<double>(kappa.plane(0)[i]); };
  return {sum_of(image, channel, [&](double v, std::size_t i) { return v > 0 && v <= limit ? k(i) * v * v : 0.0; }),
          sum_of(image, channel, [&](double v, std::size_t i) { return v > limit ? k(i) * v : 0.0; })};
}

double greatest(const Image& image, int channel) {
  std::vector<double> of_row(static_cast<std::size_t>(image.height()), 0.0);
  for_rows(image.height(), [&](int y) {
    const Real* values = image.row(channel, y);
    double& most = of_row[static_cast<std::size_t>(y)];
    for (int x = 0; x < image.width(); ++x) most = std::max(most, positive_part(values[x]));
  });
  return *std::max_element(of_row.begin(), of_row.end());
}

/// Finds the sharing of least relative squared error in which no pixel gains more than largest_gain: pixels above a
/// limit gain that, the others share by squares. The limit falls until the bound is met; each step solves for the limit
/// with the pixels that are known to lie above. Where the bound cannot be met, the limit is below all values, and all
/// pixels gain the same factor.
Sharing sharing_of(double energy, const Image& image, const Image& kappa, int channel) {
  double limit = greatest(image, channel);
  LimitedSums sums = limited_sums(image, kappa, channel, limit);
  while (std::abs(energy) * limit > largest_gain * (sums.squares + limit * sums.above) * (1 + 1e-9)) {
    const double left = std::abs(energy) - largest_gain * sums.above;
    limit = left > 0 ? std::min(largest_gain * sums.squares / left, limit * (1 - 1e-9)) : 0;
    sums = limited_sums(image, kappa, channel, limit);
    if (sums.squares > 0) continue;
    limit = below_all_values;
    sums = limited_sums(image, kappa, channel, limit);
    break;
  }
  return {limit, sums.squares + limit * sums.above};
}

/// Sums of term(x, y) over rectangles, by a summed-area table for each block of pixels. In a single table for the whole
/// image, the terms of dark surroundings would be lost in the rounding of the square of a sun.
class BoxSums {
 public:
  template <typename Term>
  BoxSums(const Image& image, const Term& term)
      : width_(static_cast<std::size_t>(image.width())), sums_(image.pixels(), 0.0) {
    for_rows((image.height() + block_side - 1) / block_side, [&](int block) {
      for (int y = block * block_side; y < std::min((block + 1) * block_side, image.height()); ++y)
        for (int x = 0; x < image.width(); ++x)
          at(x, y) = term(x, y) + before(x, y, x, y - 1) + before(x, y, x - 1, y) - before(x, y, x - 1, y - 1);
    });
  }
  double sum(const Rect& r) const {
    double total = 0;
    for (int y0 = r.y0; y0 < r.y1; y0 = end_of_block(y0))
      for (int x0 = r.x0; x0 < r.x1; x0 = end_of_block(x0)) {
        const int x = std::min(end_of_block(x0), r.x1) - 1, y = std::min(end_of_block(y0), r.y1) - 1;
        total += at(x, y) - before(x, y, x0 - 1, y) - before(x, y, x, y0 - 1) + before(x, y, x0 - 1, y0 - 1);
      }
    return total;
  }

 private:
  static constexpr int block_side = 64;
  static int end_of_block(int i) { return (i / block_side + 1) * block_side; }
  double& at(int x, int y) { return sums_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)]; }
  double at(int x, int y) const { return sums_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)]; }
  /// The entry at (x, y) if it is in the block of (in_x, in_y), or 0 if it is above or to the left of that block.
  double before(int in_x, int in_y, int x, int y) const {
    return x < in_x / block_side * block_side || y < in_y / block_side * block_side ? 0 : at(x, y);
  }

  std::size_t width_;
  std::vector<double> sums_;
};

/// Omega_o: the smallest square around an outlier over which the root mean square of every channel's gain, weighted by
/// kappa, e_o / sqrt(sum kappa x sum kappa yhat^2), is at most max_gain. kappa_sums: sums of kappa.
Rect restoration_area(const Outlier& outlier, const std::vector<BoxSums>& sums, const BoxSums& kappa_sums,
                      double max_gain, const Rect& bounds) {
  Rect area;
  for (int radius = 9;; radius += radius / 2) {
    area = intersect(grow({outlier.x, outlier.y, outlier.x + 1, outlier.y + 1}, radius), bounds);
    bool small = true;
    for (std::size_t c = 0; c < sums.size(); ++c)
      small &= std::abs(outlier.energy[c]) <= max_gain * std::sqrt(kappa_sums.sum(area) * sums[c].sum(area));
    if (small || area == bounds) return area;
  }
}

/// Records at the corners of r that value is to be added to every pixel of r; integrate() then does so.
void add_box(std::vector<double>& corners, std::size_t row, const Rect& r, double value) {
  const auto at = [&](int x, int y) -> double& {
    return corners[static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x)];
  };
  at(r.x0, r.y0) += value;
  at(r.x1, r.y0) -= value;
  at(r.x0, r.y1) -= value;
  at(r.x1, r.y1) += value;
}

void integrate(std::vector<double>& corners, std::size_t row) {
  in_parallel(corners.size() / row, [&](std::size_t y) {
    for (std::size_t i = y * row + 1; i < (y + 1) * row; ++i) corners[i] += corners[i - 1];
  });
  for (std::size_t i = row; i < corners.size(); ++i) corners[i] += corners[i - row];
}

/// Adds energy[c] to the channel c of every layer that has the beauty's primary `color`, shared out as sharing_of finds
/// it for the beauty. Does nothing if no pixel takes part.
void give_to_all(const std::vector<double>& energy, int color, const Image& kappa, Image& image) {
  const Sharing sharing = sharing_of(energy[static_cast<std::size_t>(color)], image, kappa, color);
  if (!(sharing.sum > 0)) return;
  for_rows(image.height(), [&](int y) {
    std::vector<double> parts(static_cast<std::size_t>(image.width()));
    std::transform(image.row(color, y), image.row(color, y) + image.width(), kappa.row(0, y), parts.begin(),
                   [&](Real yhat, Real k) { return sharing.of(yhat, k); });
    for (int layer = 0; layer < ColorLayout(static_cast<int>(energy.size())).layers(); ++layer) {
      const int c = ColorLayout::channel(layer, color);
      Real* out = image.row(c, y);
      for (int x = 0; x < image.width(); ++x)
        out[x] += static_cast<Real>(energy[static_cast<std::size_t>(c)] * parts[static_cast<std::size_t>(x)]);
    }
  });
}

/// The part of a gain that is within a limit.
Real part_within(double limit, double gain) {
  return std::abs(gain) > limit ? static_cast<Real>(limit / std::abs(gain)) : Real(1);
}

}  // namespace

void restore_energy(const std::vector<Outlier>& outliers, const Image& variance, double max_gain, Image& image) {
  if (outliers.empty()) return;
  const Image shape = image;  // yhat before any energy is returned
  const Image kappa = kappa_of(variance, max_gain, image);
  std::vector<BoxSums> sums;
  for (int c = 0; c < 3; ++c)
    sums.emplace_back(shape, [&](int x, int y) { return share_of(shape.at(x, y, c), kappa.at(x, y, 0)); });
  const BoxSums kappa_sums(shape, [&](int x, int y) { return static_cast<double>(kappa.at(x, y, 0)); });
  std::vector<Rect> areas(outliers.size());
  in_parallel(areas.size(), [&](std::size_t k) {
    areas[k] = restoration_area(outliers[k], sums, kappa_sums, max_gain, image.bounds());
  });
  const auto row = static_cast<std::size_t>(image.width()) + 1;
  std::vector<double> whole_image_energy(static_cast<std::size_t>(ColorLayout(image.channels()).layer_channels()), 0.0);
  Image kept(image.width(), image.height(), 3);  // part of the gain that a colour of the beauty keeps
  for (std::size_t c = 0; c < whole_image_energy.size(); ++c) {
    const auto channel = static_cast<int>(c), color = ColorLayout::beauty_channel(channel);
    std::vector<double> gain(row * (static_cast<std::size_t>(image.height()) + 1), 0.0);
    for (std::size_t k = 0; k < outliers.size(); ++k) {
      const double energy = outliers[k].energy[c], sum = sums[static_cast<std::size_t>(color)].sum(areas[k]);
      if (!(sum > 0))
        image.at(outliers[k].x, outliers[k].y, channel) += static_cast<Real>(energy);
      else if (areas[k] == image.bounds())
        whole_image_energy[c] += energy;
      else
        add_box(gain, row, areas[k], energy / sum);
    }
    integrate(gain, row);
    whole_image_energy[c] += ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t v) {
      const auto y = static_cast<int>(v);
      const double* gains = gain.data() + v * row;
      double rest = 0;
      for (int x = 0; x < image.width(); ++x) {
        const Real yhat = shape.at(x, y, color);
        const double added = share_of(yhat, kappa.at(x, y, 0)) * gains[x];
        if (channel == color) kept.at(x, y, color) = part_within(most_local_gain * positive_part(yhat), added);
        const Real part = kept.at(x, y, color);
        image.at(x, y, channel) += part * static_cast<Real>(added);
        rest += (1 - static_cast<double>(part)) * added;
      }
      return rest;
    });
  }
  if (std::all_of(whole_image_energy.begin(), whole_image_energy.end(), [](double energy) { return energy == 0; }))
    return;
  for (int color = 0; color < 3; ++color) give_to_all(whole_image_energy, color, kappa, image);
}

std::size_t restore_channels(std::size_t color_channels) {
  constexpr std::size_t in_double = sizeof(double) / sizeof(Real);
  constexpr std::size_t kappa = 1, box_sums = 4 * in_double, gain = in_double, kept = 3;
  const std::size_t image = color_channels, shape = color_channels;
  return image + shape + kappa + box_sums + gain + kept;
}

std::vector<double> channel_sums(const Image& image) {
  std::vector<double> sums;
  for (int c = 0; c < image.channels(); ++c) sums.push_back(sum_of(image, c, [](double v, std::size_t) { return v; }));
  return sums;
}

std::array<double, 3> restore_totals(const std::vector<double>& totals, const Image& variance, double noise_free,
                                     double max_gain, Image& image) {
  const Image kappa = kappa_of(variance, noise_free, image);
  const std::vector<double> found = channel_sums(image);
  std::vector<double> missing(totals.size());
  for (std::size_t c = 0; c < totals.size(); ++c) missing[c] = totals[c] - found[c];
  std::array<double, 3> gains{};
  for (int color = 0; color < 3; ++color) {
    const auto c = static_cast<std::size_t>(color);
    const double positive = sum_of(image, color, [](double v, std::size_t) { return std::max(v, 0.0); });
    const double gain = positive > 0 ? missing[c] / positive : 0;
    if (!(std::abs(gain) <= max_gain) || !(positive > 0)) continue;
    gains[c] = gain;
    give_to_all(missing, color, kappa, image);
  }
  return gains;
}

}  // namespace polyrecon
