#include "outliers/restore.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/parallel.h"
#include "core/sanitise.h"

namespace polyrecon {
namespace {

/// Of the brightest pixel, by squares; where it would be more, as where all but a few pixels are dark, each pixel's
/// gain is the same.
constexpr double kMostGain = 0.5;

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

/// yhat^2 of a pixel. What is not positive receives nothing.
double share_of(Real value) {
  const double yhat = usable(value) ? static_cast<double>(value) : 0;
  return yhat > 0 ? yhat * yhat : 0;
}

double positive_part(Real value) { return usable(value) ? std::max(static_cast<double>(value), 0.0) : 0; }

double greatest(const Image& image, int channel) {
  double most = 0;
  const Real* values = image.plane(channel);
  for (std::size_t i = 0; i < image.pixels(); ++i) most = std::max(most, positive_part(values[i]));
  return most;
}

/// Summed-area table of a channel's shares: sums over rectangles in four look-ups.
class BoxSums {
 public:
  explicit BoxSums(const Image& image, int channel)
      : row_(static_cast<std::size_t>(image.width()) + 1),
        sums_(row_ * (static_cast<std::size_t>(image.height()) + 1), 0.0) {
    for (int y = 0; y < image.height(); ++y) {
      double row = 0;
      const Real* values = image.row(channel, y);
      for (int x = 0; x < image.width(); ++x) {
        row += share_of(values[x]);
        at(x + 1, y + 1) = at(x + 1, y) + row;
      }
    }
  }
  double sum(const Rect& r) const { return at(r.x1, r.y1) - at(r.x0, r.y1) - at(r.x1, r.y0) + at(r.x0, r.y0); }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * row_ + static_cast<std::size_t>(x); }
  double& at(int x, int y) { return sums_[index(x, y)]; }
  double at(int x, int y) const { return sums_[index(x, y)]; }

  std::size_t row_;
  std::vector<double> sums_;
};

/// The square around an outlier over which the root mean square of every channel's gain, e_o / sqrt(|Omega| sum
/// yhat^2), is small enough.
Rect restoration_area(const Outlier& outlier, const std::vector<BoxSums>& sums, double max_gain, const Rect& bounds) {
  Rect area;
  for (int radius = 9;; radius += radius / 2) {
    area = intersect(grow({outlier.x, outlier.y, outlier.x + 1, outlier.y + 1}, radius), bounds);
    bool small = true;
    for (std::size_t c = 0; c < sums.size(); ++c)
      small &=
          std::abs(outlier.energy[c]) <= max_gain * std::sqrt(static_cast<double>(area.area()) * sums[c].sum(area));
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
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (i % row != 0) corners[i] += corners[i - 1];
  for (std::size_t i = row; i < corners.size(); ++i) corners[i] += corners[i - row];
}

/// Adds energy[c] to channel c = color, color + 3, ..., in proportion to share(yhat) of `color`, the sum of which is
/// `shares`.
void give(const std::vector<double>& energy, int color, double (*share)(Real), double shares, Image& image) {
  for_rows(image.height(), [&](int y) {
    std::vector<double> parts(static_cast<std::size_t>(image.width()));
    const Real* yhat = image.row(color, y);
    for (int x = 0; x < image.width(); ++x) parts[static_cast<std::size_t>(x)] = share(yhat[x]) / shares;
    for (int c = color; c < static_cast<int>(energy.size()); c += 3) {
      Real* out = image.row(c, y);
      for (int x = 0; x < image.width(); ++x)
        out[x] += static_cast<Real>(energy[static_cast<std::size_t>(c)] * parts[static_cast<std::size_t>(x)]);
    }
  });
}

}  // namespace

void restore_energy(const std::vector<Outlier>& outliers, double max_gain, Image& image) {
  if (outliers.empty()) return;
  const Image shape = image;  // yhat before anything is given back
  std::vector<BoxSums> sums;
  for (int c = 0; c < 3; ++c) sums.emplace_back(shape, c);
  std::vector<Rect> areas;
  for (const Outlier& outlier : outliers) areas.push_back(restoration_area(outlier, sums, max_gain, image.bounds()));
  const auto row = static_cast<std::size_t>(image.width()) + 1;
  for (int c = 0; c < image.channels() / 3 * 3; ++c) {
    const auto color = static_cast<std::size_t>(c % 3);
    std::vector<double> gain(row * (static_cast<std::size_t>(image.height()) + 1), 0.0);
    for (std::size_t k = 0; k < outliers.size(); ++k) {
      const double energy = outliers[k].energy[static_cast<std::size_t>(c)], sum = sums[color].sum(areas[k]);
      if (sum > 0)
        add_box(gain, row, areas[k], energy / sum);
      else
        image.at(outliers[k].x, outliers[k].y, c) += static_cast<Real>(energy);
    }
    integrate(gain, row);
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) {
        image.at(x, y, c) += static_cast<Real>(share_of(shape.at(x, y, static_cast<int>(color))) *
                                               gain[static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x)]);
      }
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
    const double squares = BoxSums(image, color).sum(image.bounds());
    if (std::abs(missing[c]) * greatest(image, color) <= kMostGain * squares)
      give(missing, color, share_of, squares, image);
    else
      give(missing, color, positive_part, positive, image);
  }
  return gains;
}

}  // namespace polyrecon
