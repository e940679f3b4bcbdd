#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace polyrecon {

/// The weighted mean of a stream of samples.
struct MeanAccumulator {
  double weight = 0, mean = 0;
  int renders = 0;

  void add(double x, double w) {
    ++renders;
    weight += w;
    mean += (x - mean) * w / weight;
  }
};

/// The weighted mean and the variance of that mean, by the sums of w^2, w^2 d and w^2 d^2. d is the distance to the
/// first sample; sums of the samples themselves would cancel.
struct Accumulator : MeanAccumulator {
  double origin = 0, squares = 0, first = 0, second = 0;

  void add(double x, double w) {
    if (renders == 0) origin = x;
    MeanAccumulator::add(x, w);
    const double d = x - origin;
    squares += w * w;
    first += w * w * d;
    second += w * w * d * d;
  }
  bool spreads() const { return second > 0; }
  double variance_of_mean() const {
    if (renders < 2) return std::numeric_limits<double>::quiet_NaN();
    const double m = mean - origin;
    return std::max(0.0, second - 2 * m * first + m * m * squares) / (weight * weight - squares);
  }
};

/// The accumulators of one channel, one for each pixel of a band.
struct ChannelSums {
  std::vector<Accumulator> all;
  std::vector<MeanAccumulator> half_a, half_b;

  static constexpr std::size_t bytes_per_pixel = sizeof(Accumulator) + 2 * sizeof(MeanAccumulator);

  explicit ChannelSums(std::size_t pixels) : all(pixels), half_a(pixels), half_b(pixels) {}
};

}  // namespace polyrecon
