#include "prior/exposure.h"

#include "core/color_layout.h"
#include "core/repair.h"

namespace polyrecon {
namespace {

// Largest ratio between the exposures of a frame and its prior; beyond it the prior is a different image.
constexpr double most_gain = 2;

/// Factor that scales a channel of the prior to the pair's sum over the pixels where the prior is usable; 1 if the
/// factor would be outside of 1 / most_gain to most_gain.
double exposure_gain(const Image& prior, const HalfPair& pair, int c) {
  double noisy = 0, denoised = 0;
  for (std::size_t i = 0; i < prior.pixels(); ++i) {
    if (!usable(prior.plane(c)[i])) continue;
    noisy += 0.5 * (static_cast<double>(pair.color[0].plane(c)[i]) + static_cast<double>(pair.color[1].plane(c)[i]));
    denoised += static_cast<double>(prior.plane(c)[i]);
  }
  const double gain = noisy / denoised;
  return gain >= 1 / most_gain && gain <= most_gain ? gain : 1;
}

}  // namespace

Image in_exposure(Image prior, const HalfPair& pair, const Image& fallback) {
  for (int c = 0; c < ColorLayout::primaries; ++c) {
    const auto gain = static_cast<Real>(exposure_gain(prior, pair, c));
    for (std::size_t i = 0; i < prior.pixels(); ++i) {
      const Real value = prior.plane(c)[i];
      prior.plane(c)[i] = usable(value) ? gain * value : fallback.plane(c)[i];
    }
  }
  return prior;
}

}  // namespace polyrecon
