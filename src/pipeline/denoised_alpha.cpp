#include "pipeline/denoised_alpha.h"

#include <algorithm>
#include <utility>

#include "core/gaussian.h"
#include "core/repair.h"
#include "noise/variance.h"

namespace polyrecon {
namespace {

constexpr double share_sigma = 2;  // pixels

}  // namespace

Image denoised_alpha(const Frame& frame, Image alpha, const Image& mask, double correlation, Progress& progress) {
  Image input = frame.alpha;
  repair_nonfinite(input, 2);
  const Image no_features(input.width(), input.height(), 0);
  Image variance = estimate_variance(input, no_features, progress, mask, frame.sample_count, correlation);
  Image change(input.width(), input.height(), 1);
  for (std::size_t i = 0; i < input.pixels(); ++i) {
    alpha.plane(0)[i] = std::clamp(alpha.plane(0)[i], Real(0), Real(1));
    const Real d = alpha.plane(0)[i] - input.plane(0)[i];
    change.plane(0)[i] = d * d;
  }
  variance = gaussian_blur(variance, share_sigma, mask);
  change = gaussian_blur(change, share_sigma, mask);
  for (std::size_t i = 0; i < input.pixels(); ++i) {
    const Real noise = variance.plane(0)[i], moved = change.plane(0)[i];
    if (moved > noise)
      alpha.plane(0)[i] =
          std::clamp(input.plane(0)[i] + noise / moved * (alpha.plane(0)[i] - input.plane(0)[i]), Real(0), Real(1));
  }
  return alpha;
}

}  // namespace polyrecon
