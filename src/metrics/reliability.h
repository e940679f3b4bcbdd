#pragma once

#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

/// Means over a tenth of the pixels.
struct ReliabilityDecile {
  double estimated = 0, measured = 0;
};

/// Compares an estimate of the relative squared error with the true one by tenths of the pixels, from the lowest
/// estimates to the highest. estimated: 1 channel. The reference's noise, where its variance is known, does not count.
/// Pixels that are not finite in one of the images are left out.
std::vector<ReliabilityDecile> reliability(const Image& estimated, const Image& image, const Image& reference,
                                           const Image& reference_variance);

}  // namespace polyrecon
