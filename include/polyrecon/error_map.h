#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// The estimated error of a reconstruction.
struct ErrorMap {
  Image mse;                ///< 3 channels: E[(yhat - mu)^2] per channel, radiance squared.
  Image relative_mse;       ///< 1 channel: mean over RGB of mse / (yhat^2 + 0.01).
  Image relative_variance;  ///< 1 channel: the part of relative_mse that is variance; the rest is bias.
  Image relative_noise;     ///< 1 channel: mean over RGB of the noise variance of the input's mean / (yhat^2 + 0.01);
                            ///< empty where an error map from elsewhere does not tell.
  double mean_relative_mse = 0;  ///< Of the whole image.
};

}  // namespace polyrecon
