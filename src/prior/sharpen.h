#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// Sharpens a blurred prior p to the sharpness of the reconstruction f: p + k1 L1 p + k2 L2 p. L_d is the discrete
/// Laplacian at distance d: the sum of the four neighbours at that distance less four times the pixel, with border
/// pixels repeated. k1 and k2 are one pair for the image, found by least squares against f with each term relative to
/// the larger of p^2 and f^2. They are fitted to f and not to the samples, since noise of the samples that the prior
/// kept would look like sharpness. The result is negative only where p is. A prior that is at least as sharp as f, that
/// is k1 >= 0 for L1 alone, is returned unchanged. Both images have 3 channels, finite values and one size.
/// epsilon: added to the squares; as in HalfPair.
Image sharpen_to(Image prior, const Image& reconstruction, double epsilon);

}  // namespace polyrecon
