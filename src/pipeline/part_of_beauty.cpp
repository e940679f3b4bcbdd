#include "pipeline/part_of_beauty.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/halves.h"

namespace polyrecon {
namespace {

// Share of the pixels that may be noisy outside the beauty.
constexpr double most_outside = 0.001;
// A standard deviation of less than this share of the radiance is rounding, not noise.
constexpr double least_noise = 0.01;

/// An estimate of the noise of a pixel: that of the file, else its difference to the pixel on its left.
double deviation(const Pass& pass, int x, int y, int c) {
  if (!pass.variance.empty()) return std::sqrt(std::max<double>(pass.variance.at(x, y, c), 0));
  if (pass.has_halves()) return std::sqrt(variance_of_mean<double>(pass.half_a.at(x, y, c), pass.half_b.at(x, y, c)));
  const int adjacent = x > 0 ? x - 1 : std::min(x + 1, pass.mean.width() - 1);
  return std::abs(static_cast<double>(pass.mean.at(x, y, c)) - static_cast<double>(pass.mean.at(adjacent, y, c)));
}

/// Whether the layer is noisy in a pixel in which no channel of the beauty is.
bool is_noisy_outside(const Pass& beauty, const Pass& layer, int x, int y) {
  bool noisy = false;
  for (int c = 0; c < 3; ++c) {
    if (!(deviation(beauty, x, y, c) == 0)) return false;
    const double radiance = std::max(std::abs(static_cast<double>(beauty.mean.at(x, y, c))),
                                     std::abs(static_cast<double>(layer.mean.at(x, y, c))));
    noisy = noisy || deviation(layer, x, y, c) > least_noise * radiance;
  }
  return noisy;
}

}  // namespace

bool is_part_of_beauty(const Frame& frame, const Pass& layer) {
  std::size_t outside = 0;
  for (int y = 0; y < frame.height(); ++y)
    for (int x = 0; x < frame.width(); ++x) outside += is_noisy_outside(frame.beauty, layer, x, y);
  return static_cast<double>(outside) <= most_outside * static_cast<double>(frame.beauty.mean.pixels());
}

std::vector<std::string> layers_outside_beauty(const Frame& frame) {
  std::vector<std::string> names;
  for (const Pass& layer : frame.aovs)
    if (!is_part_of_beauty(frame, layer)) names.push_back(layer.name);
  return names;
}

std::string note_of_layer_outside_beauty(const std::string& name) {
  return name +
         " gets windows of its own: it is noisy where the beauty has no noise, so it is no part of it and does " +
         "not add up with the other layers; without --aov it stays as it is, --map beauty=LAYER denoises another layer "
         "in a run of its own";
}

}  // namespace polyrecon
