#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// A blurred prior, made as sharp as our own result: p + k1 L1 p + k2 L2 p, with L_d the sum of the four neighbours at
/// distance d less four times the pixel, the discrete Laplacian (border pixels repeated), never below 0 by it. k1 and
/// k2 are one pair for the image, by least squares against own; terms are relative to the brighter of the two squared.
/// Own, as against the samples, does not hold the noise that a prior may have kept, which would pass for sharpness.
/// Nothing is done where L1 alone does not ask for sharpening, k1 < 0: a prior may be as sharp as it likes.
/// 3 channels, finite, of one size; epsilon as in the error measure, radiance squared.
Image sharpen_to(Image prior, const Image& own, double epsilon);

}  // namespace polyrecon
