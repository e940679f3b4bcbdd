#pragma once

#include "blend/select.h"
#include "core/image.h"
#include "features/half_pair.h"

namespace polyrecon {

/// The estimated error of a reconstruction: equation (4), blended over the windows like the image itself.
struct ErrorMap {
  Image mse;                ///< 3 channels: E[(yhat - mu)^2] per channel, radiance squared.
  Image relative_mse;       ///< 1 channel: mean over RGB of mse / (yhat^2 + 0.01).
  Image relative_variance;  ///< 1 channel: the part of relative_mse that falls as 1/n with n more samples; the rest is bias.
  double cross_validated = 0;  ///< Relative MSE of the whole image by cross-validation (cross_validated_error).
  double calibration = 1;      ///< Factor that the windows' own estimate was multiplied by to agree with it.
};

/// Unbiased estimate of the image's relative MSE from the halves alone:
///     mean of [ ((f_A - B)^2 + (f_B - A)^2) / 2 - Var - (f_A - f_B)^2 / 4 ] / (yhat^2 + 0.01)
/// where Var is the noise variance of one half. It does not use the windows' model of bias and variance, so it can judge it.
double cross_validated_error(const HalfPair& pair, const Candidate& result);

/// The error map of a result, whose windows' estimates are scaled by one factor so that their mean agrees with the
/// cross-validated error. A factor is not applied where it would be below 1/16 or above 16 (then one of the two is not to be
/// trusted, and the report shows both).
ErrorMap make_error_map(const HalfPair& pair, const Candidate& result);

}  // namespace polyrecon
