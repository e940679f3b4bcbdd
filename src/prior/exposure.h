#pragma once

#include "core/half_pair.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// The prior in the exposure of the pair: each channel is scaled to the sum of the noisy halves if that takes a factor
/// of 1/2 to 2. Noise hardly changes a sum over the frame, so the factor is a difference in exposure. Pixels that are
/// not usable get the value of `fallback`, as do all pixels of a prior without a usable one. 3 channels each.
Image in_exposure(Image prior, const HalfPair& pair, const Image& fallback);

}  // namespace polyrecon
