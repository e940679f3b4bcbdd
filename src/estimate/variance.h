#pragma once

#include <string>

#include "core/frame.h"
#include "core/progress.h"

namespace polyrecon {

struct NoiseVariance {
  Image variance;        ///< Of the beauty's mean, 3 channels, radiance squared.
  std::string source;    ///< "from the file", "from the half buffers" or "estimated from the image".
  bool measured = true;  ///< False where it was estimated from the image: then it knows regions, not single pixels.
};

/// Whether the frame itself tells the noise of its beauty, by a variance or by half buffers.
bool noise_is_measured(const Frame& frame);

/// The noise variance of the beauty: what the file says; else (A - B)^2 / 4 of the half buffers, smoothed; else
/// estimated.
NoiseVariance noise_variance(const Frame& frame, Progress& progress);

/// Estimates the noise variance of an image that comes without any: the residual variance sum r^2 / (n - tr H) of local
/// fits (constant, features, plane over 7 x 7 pixels, every second pixel), of which each pixel takes the median of the
/// fits around it: the few windows that straddle an edge, which call the edge noise, lose the vote. What rounding to
/// half floats explains (a deviation of at most 2^-11 of the value) is no noise: 0.
Image estimate_variance(const Frame& frame, Progress& progress);

}  // namespace polyrecon
