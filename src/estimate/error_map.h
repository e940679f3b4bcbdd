#pragma once

#include "blend/select.h"
#include "core/image.h"
#include "features/half_pair.h"

namespace polyrecon {

/// The estimated error of a reconstruction: equation (4), blended over the windows like the image itself.
struct ErrorMap {
  Image mse;                ///< 3 channels: E[(yhat - mu)^2] per channel, radiance squared.
  Image relative_mse;       ///< 1 channel: mean over RGB of mse / (yhat^2 + 0.01).
  Image relative_variance;  ///< 1 channel: the part of relative_mse that is variance; the rest is bias.
  Image relative_noise;     ///< 1 channel: mean over RGB of the noise variance of the input's mean / (yhat^2 + 0.01);
                            ///< empty where an error map from elsewhere does not tell.
  double mean_relative_mse = 0;  ///< Of the whole image.
  double cross_validated = 0;    ///< The same by cross-validation: see cross_validated_error.
  double calibration = 1;        ///< Measured variance of the blend over the variance that its windows claim.
};

/// Relative MSE of the whole image from the halves alone:
///     mean of [ ((f_A - B)^2 + (f_B - A)^2) / 2 - Var - (f_A - f_B)^2 / 4 ] / (yhat^2 + 0.01)
/// where Var is the noise variance of one half: twice that of the mean, or the pair's where an outlier was replaced.
/// Unbiased for a reconstruction f_A that never saw B; the windows of f_A are weighed by B, so here it is a lower
/// bound, near the truth at high sample counts, and may be negative.
double cross_validated_error(const HalfPair& pair, const Image& variance, const Candidate& result);

/// The error map of a result: the windows' bias^2 (5), and their variance (6) scaled by one factor. A window does not
/// know that its neighbours average its noise away; (f_A - f_B)^2 / 4 does, so the factor makes the two agree over the
/// image. variance: of the mean's noise as it was measured (HalfPair's has a floor); where it is
/// negative or no number, HalfPair's stands in.
ErrorMap make_error_map(const HalfPair& pair, const Image& variance, const Candidate& result);

}  // namespace polyrecon
