#pragma once

#include "polyrecon/image.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// Pixels that gaussian_blur reaches: the kernel is cut at three standard deviations.
int gaussian_reach(double sigma);

/// Every channel convolved with a Gaussian of standard deviation sigma (pixels), normalised over the taps that lie
/// inside the image, so that a constant stays a constant up to the border.
Image gaussian_blur(const Image& image, double sigma);

}  // namespace polyrecon
