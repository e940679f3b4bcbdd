#pragma once

#include "polyrecon/image.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// Radius of the kernel of gaussian_blur, which is cut at three standard deviations.
int gaussian_radius(double sigma);

/// Convolves every channel with a Gaussian of standard deviation sigma (pixels). The kernel is normalised over the taps
/// that are inside the image, so a constant stays a constant up to the border.
Image gaussian_blur(const Image& image, double sigma);

/// The same over the pixels inside a mask (core/mask.h): what is beyond them counts like what is beyond the
/// border. 0 where there are none.
Image gaussian_blur(const Image& image, double sigma, const Image& mask);

}  // namespace polyrecon
