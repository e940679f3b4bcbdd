#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// Raises variances that are too small for their neighbourhood. A variance that was computed from a few samples can be
/// far too small, or zero, where radiance comes in rare spikes: a pixel that no spike has hit yet looks exact, gives
/// all its neighbours no weight and stays a dark speck. So the variance of a pixel becomes at least
/// - the median over its 5 x 5 neighbourhood, computed as the mean of the median of its columns' medians and the median
///   of its rows' medians, and
/// - half of the square of the mean standard deviation over the neighbourhood. The mean variance would be dominated by
///   the brightest spike.
/// A neighbourhood without any noise keeps variance 0. Border pixels are repeated outside the image.
/// variance: >= 0, any channels. Returns the same shape.
Image floor_variance(const Image& variance);

}  // namespace polyrecon
