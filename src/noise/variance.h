#pragma once

#include <string>

#include "polyrecon/frame.h"
#include "polyrecon/progress.h"

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

/// Estimates the noise variance of an image that comes without any, from the residuals r of local fits (constant,
/// features, plane over 7 x 7 pixels, every second pixel). The noise of pixels is independent, what a fit leaves of
/// texture is not: with N the variance of noise, T that of texture, a the correlation of its neighbours, h the mean of
/// H over pairs of neighbours,
///     s^2 = sum r^2 / (n - tr H) = N + T,   c = mean over the pairs of r_i r_j = a T - h N,
///     N = (s^2 - c / a) / (1 + h / a),   a = 1/2.
/// Each pixel takes the median of the fits around it: the few windows that straddle an edge lose the vote. It is raised
/// where the pixel itself is a spike (spike_variance.h). Zero radiance has seen no light in any sample and is exact; so
/// is what rounding to half floats explains (a deviation of at most 2^-11 of the value).
/// y: finite, any channels. features: finite, of y's size, may have no channels. Returns y's shape, y's unit squared.
Image estimate_variance(const Image& y, const Image& features, Progress& progress);

/// Whether a feature's noise is estimated: where no variance and no half buffers tell it. Depth, of which the estimate
/// gains nothing, is taken as it is.
bool variance_is_estimated(FeatureKind kind, bool told);

/// Gives the features whose noise is estimated a variance: renderers carry features through reflections and blur, and
/// a model that takes their noise for detail keeps the beauty's with it.
void estimate_feature_variance(Frame& frame, Progress& progress);

}  // namespace polyrecon
