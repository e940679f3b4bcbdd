#include "outliers/restore.h"

#include <algorithm>
#include <cmath>

#include "core/color_layout.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "core/repair.h"

namespace polyrecon {
namespace {

/// Of a pixel, where the whole image takes part; more only where all must gain more.
constexpr double kMostGain = 0.5;

constexpr double kBelowAll = 1e-100;  ///< No positive value of an image is less.

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

/// kappa of every pixel, of the brightness (one channel, one table of sums): how far it takes part in what is given
/// back.
Image parts_of(const Image& variance, double quiet, const Image& image) {
  Image part(image.width(), image.height(), 1);
  for_rows(image.height(), [&](int y) {
    for (int x = 0; x < image.width(); ++x) {
      double sigma = 0, yhat = 0;
      for (int c = 0; c < 3; ++c) {
        sigma += std::sqrt(0.5 * static_cast<double>(variance.at(x, y, c)));  // of the mean of the halves
        yhat += positive_part(image.at(x, y, c));
      }
      part.at(x, y, 0) = static_cast<Real>(sigma < quiet * yhat ? sigma / (quiet * yhat) : 1);
    }
  });
  return part;
}

/// kappa yhat^2 of a pixel. What is not positive receives nothing.
double share_of(Real value, Real part) {
  const double yhat = positive_part(value);
  return static_cast<double>(part) * yhat * yhat;
}

/// How energy given to all pixels of a channel is shared out: kappa yhat min(yhat, limit) / sum of that.
struct Sharing {
  double limit = 0, sum = 0;  ///< 0: no pixel is positive.

  double of(Real value, Real part) const {
    const double yhat = positive_part(value);
    return static_cast<double>(part) * yhat * std::min(yhat, limit) / sum;
  }
};

/// What is left to the pixels up to a limit, and what the others hold.
struct Light {
  double squares, above;
};

Light light_of(const Image& image, const Image& part, int channel, double limit) {
  const auto kappa = [&](std::size_t i) { return static_cast<double>(part.plane(0)[i]); };
  return {sum_of(image, channel, [&](double v, std::size_t i) { return v > 0 && v <= limit ? kappa(i) * v * v : 0.0; }),
          sum_of(image, channel, [&](double v, std::size_t i) { return v > limit ? kappa(i) * v : 0.0; })};
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

/// By squares, which cost the least relative squared error, with no pixel's gain above kMostGain: what is brighter than
/// the limit gains that, which is the least error under this bound (the limit falls until the gain is met; each step
/// solves for it with the pixels known to lie above). Where the bound cannot be kept all gain alike.
Sharing sharing_of(double energy, const Image& image, const Image& part, int channel) {
  double limit = greatest(image, channel);
  Light light = light_of(image, part, channel, limit);
  while (std::abs(energy) * limit > kMostGain * (light.squares + limit * light.above) * (1 + 1e-9)) {
    const double left = std::abs(energy) - kMostGain * light.above;
    limit = left > 0 ? std::min(kMostGain * light.squares / left, limit * (1 - 1e-9)) : 0;
    light = light_of(image, part, channel, limit);
    if (light.squares > 0) continue;
    limit = kBelowAll;
    light = light_of(image, part, channel, limit);
    break;
  }
  return {limit, light.squares + limit * light.above};
}

/// Sums of term(x, y) over rectangles, by a summed-area table for each block of pixels: in one for the whole
/// image the square of a sun would drown what its dark surroundings add.
class BoxSums {
 public:
  template <typename Term>
  BoxSums(const Image& image, const Term& term)
      : width_(static_cast<std::size_t>(image.width())), sums_(image.pixels(), 0.0) {
    for_rows((image.height() + kBlock - 1) / kBlock, [&](int block) {
      for (int y = block * kBlock; y < std::min((block + 1) * kBlock, image.height()); ++y)
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
  static constexpr int kBlock = 64;
  static int end_of_block(int i) { return (i / kBlock + 1) * kBlock; }
  double& at(int x, int y) { return sums_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)]; }
  double at(int x, int y) const { return sums_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)]; }
  /// The entry at (x, y) where that lies in the block of (in_x, in_y), which it is above or left of; else 0.
  double before(int in_x, int in_y, int x, int y) const {
    return x < in_x / kBlock * kBlock || y < in_y / kBlock * kBlock ? 0 : at(x, y);
  }

  std::size_t width_;
  std::vector<double> sums_;
};

/// The square around an outlier over which the root mean square of every channel's gain, weighed by kappa,
/// e_o / sqrt(sum kappa x sum kappa yhat^2), is small enough.
Rect restoration_area(const Outlier& outlier, const std::vector<BoxSums>& sums, const BoxSums& taking_part,
                      double max_gain, const Rect& bounds) {
  Rect area;
  for (int radius = 9;; radius += radius / 2) {
    area = intersect(grow({outlier.x, outlier.y, outlier.x + 1, outlier.y + 1}, radius), bounds);
    bool small = true;
    for (std::size_t c = 0; c < sums.size(); ++c)
      small &= std::abs(outlier.energy[c]) <= max_gain * std::sqrt(taking_part.sum(area) * sums[c].sum(area));
    if (small || area == bounds) return area;
  }
}

/// Adds value to every pixel of r once `integrate` has run.
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

/// Adds energy[c] to the channels c = color, color + 3, ... as sharing_of has it for `color`. Nothing where no pixel of
/// that takes part.
void give_to_all(const std::vector<double>& energy, int color, const Image& part, Image& image) {
  const Sharing sharing = sharing_of(energy[static_cast<std::size_t>(color)], image, part, color);
  if (!(sharing.sum > 0)) return;
  for_rows(image.height(), [&](int y) {
    std::vector<double> parts(static_cast<std::size_t>(image.width()));
    std::transform(image.row(color, y), image.row(color, y) + image.width(), part.row(0, y), parts.begin(),
                   [&](Real yhat, Real kappa) { return sharing.of(yhat, kappa); });
    for (int layer = 0; layer < ColorLayout(static_cast<int>(energy.size())).layers(); ++layer) {
      const int c = ColorLayout::channel(layer, color);
      Real* out = image.row(c, y);
      for (int x = 0; x < image.width(); ++x)
        out[x] += static_cast<Real>(energy[static_cast<std::size_t>(c)] * parts[static_cast<std::size_t>(x)]);
    }
  });
}

}  // namespace

void restore_energy(const std::vector<Outlier>& outliers, const Image& variance, double max_gain, Image& image) {
  if (outliers.empty()) return;
  const Image shape = image;  // yhat before anything is given back
  const Image part = parts_of(variance, max_gain, image);
  std::vector<BoxSums> sums;
  for (int c = 0; c < 3; ++c)
    sums.emplace_back(shape, [&](int x, int y) { return share_of(shape.at(x, y, c), part.at(x, y, 0)); });
  const BoxSums taking_part(shape, [&](int x, int y) { return static_cast<double>(part.at(x, y, 0)); });
  std::vector<Rect> areas(outliers.size());
  in_parallel(areas.size(), [&](std::size_t k) {
    areas[k] = restoration_area(outliers[k], sums, taking_part, max_gain, image.bounds());
  });
  const auto row = static_cast<std::size_t>(image.width()) + 1;
  std::vector<double> of_all(static_cast<std::size_t>(ColorLayout(image.channels()).layer_channels()), 0.0);
  for (std::size_t c = 0; c < of_all.size(); ++c) {
    const auto channel = static_cast<int>(c), color = ColorLayout::beauty_channel(channel);
    std::vector<double> gain(row * (static_cast<std::size_t>(image.height()) + 1), 0.0);
    for (std::size_t k = 0; k < outliers.size(); ++k) {
      const double energy = outliers[k].energy[c], sum = sums[static_cast<std::size_t>(color)].sum(areas[k]);
      if (!(sum > 0))
        image.at(outliers[k].x, outliers[k].y, channel) += static_cast<Real>(energy);
      else if (areas[k] == image.bounds())
        of_all[c] += energy;
      else
        add_box(gain, row, areas[k], energy / sum);
    }
    integrate(gain, row);
    for_rows(image.height(), [&](int y) {
      const double* gains = gain.data() + static_cast<std::size_t>(y) * row;
      for (int x = 0; x < image.width(); ++x)
        image.at(x, y, channel) += static_cast<Real>(share_of(shape.at(x, y, color), part.at(x, y, 0)) * gains[x]);
    });
  }
  if (std::all_of(of_all.begin(), of_all.end(), [](double energy) { return energy == 0; })) return;
  for (int color = 0; color < 3; ++color) give_to_all(of_all, color, part, image);
}

std::size_t restore_channels(std::size_t color_channels) {
  constexpr std::size_t in_double = sizeof(double) / sizeof(Real);
  constexpr std::size_t part = 1, box_sums = 4 * in_double, gain = in_double;
  const std::size_t image = color_channels, shape = color_channels;
  return image + shape + part + box_sums + gain;
}

std::vector<double> channel_sums(const Image& image) {
  std::vector<double> sums;
  for (int c = 0; c < image.channels(); ++c) sums.push_back(sum_of(image, c, [](double v, std::size_t) { return v; }));
  return sums;
}

void restore_everywhere(const std::vector<double>& energy, const Image& variance, double quiet, Image& image) {
  const Image part = parts_of(variance, quiet, image);
  for (int color = 0; color < 3; ++color) give_to_all(energy, color, part, image);
}

std::array<double, 3> restore_totals(const std::vector<double>& totals, const Image& variance, double quiet,
                                     double max_gain, Image& image) {
  const Image part = parts_of(variance, quiet, image);
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
    give_to_all(missing, color, part, image);
  }
  return gains;
}

}  // namespace polyrecon
