#include "outliers/restore.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/sanitise.h"

namespace polyrecon {
namespace {

/// Summed-area table: sums over rectangles in four look-ups.
class BoxSums {
 public:
  explicit BoxSums(const Image& image, int channel)
      : row_(static_cast<std::size_t>(image.width()) + 1),
        sums_(row_ * (static_cast<std::size_t>(image.height()) + 1), 0.0) {
    for (int y = 0; y < image.height(); ++y) {
      double row = 0;
      const Real* values = image.row(channel, y);
      for (int x = 0; x < image.width(); ++x) {
        row += std::max(static_cast<double>(values[x]), 0.0);
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

/// The square around an outlier over which every channel's gain is small enough.
Rect restoration_area(const Outlier& outlier, const std::vector<BoxSums>& sums, double max_gain, const Rect& bounds) {
  Rect area;
  for (int radius = 9;; radius += radius / 2) {
    area = intersect(grow({outlier.x, outlier.y, outlier.x + 1, outlier.y + 1}, radius), bounds);
    bool small = true;
    for (std::size_t c = 0; c < sums.size(); ++c) small &= std::abs(outlier.energy[c]) <= max_gain * sums[c].sum(area);
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
        const double yhat = std::max(static_cast<double>(shape.at(x, y, static_cast<int>(color))), 0.0);
        image.at(x, y, c) +=
            static_cast<Real>(yhat * gain[static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x)]);
      }
  }
}

std::vector<double> channel_sums(const Image& image) {
  std::vector<double> sums;
  for (int c = 0; c < image.channels(); ++c)
    sums.push_back(ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t y) {
      double row = 0;
      const Real* values = image.row(c, static_cast<int>(y));
      for (int x = 0; x < image.width(); ++x)
        if (usable(values[x])) row += static_cast<double>(values[x]);
      return row;
    }));
  return sums;
}

std::array<double, 3> restore_totals(const std::vector<double>& totals, double max_gain, Image& image) {
  const std::vector<double> found = channel_sums(image);
  const Image shape = image;
  std::array<double, 3> gains{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double positive = BoxSums(shape, static_cast<int>(c)).sum(image.bounds());
    const double gain = positive > 0 ? (totals[c] - found[c]) / positive : 0;
    if (!(std::abs(gain) <= max_gain)) continue;
    gains[c] = gain;
    for (std::size_t k = c; k < totals.size(); k += 3) {
      const double part = (totals[k] - found[k]) / positive;
      const Real* yhat = shape.plane(static_cast<int>(c));
      Real* out = image.plane(static_cast<int>(k));
      if (positive > 0)
        for (std::size_t i = 0; i < image.pixels(); ++i)
          out[i] += static_cast<Real>(part * std::max(static_cast<double>(yhat[i]), 0.0));
    }
  }
  return gains;
}

}  // namespace polyrecon
