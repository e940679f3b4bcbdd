#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// A variance estimated from a few samples can be far too small, or zero, where light comes in rare spikes: a pixel
/// that no spike has hit yet believes that it is exact, refuses all neighbours and stays a dark speck. Each pixel
/// therefore claims at least the median of its 5 x 5 neighbourhood (the mean of the medians of its columns' and of its
/// rows' medians) and half of the square of its mean standard deviation (the mean variance would be the brightest
/// spike's alone). Where a whole neighbourhood is free of noise it stays so. Beyond the border the nearest pixel
/// counts.
Image floor_variance(const Image& variance);

}  // namespace polyrecon
