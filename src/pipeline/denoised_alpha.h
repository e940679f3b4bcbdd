#pragma once

#include "polyrecon/frame.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// The alpha that the windows of the beauty make, within 0 and 1, as far as the noise of the input's alpha goes. These
/// windows may not know the edges of alpha. So alpha moves from the input a to the result r by the share
///     min(1, G v / G (r - a)^2),
/// with v the variance of a, estimated from a alone, and G a Gaussian of 2 pixels: an alpha without noise stays as it
/// is. mask: the pixels that take part (core/mask.h). correlation: of the noise of neighbouring pixels.
Image denoised_alpha(const Frame& frame, Image alpha, const Image& mask, double correlation, Progress& progress);

}  // namespace polyrecon
