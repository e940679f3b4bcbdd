// The error map: how wrong each pixel of a result may be.
#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// The estimated error of a result yhat against the true image mu. All images have the size of the frame.
struct ErrorMap {
  Image mse;                ///< 3 channels: E[(yhat - mu)^2], radiance squared.
  Image relative_mse;       ///< 1 channel: mean over RGB of mse / (yhat^2 + 0.01).
  Image relative_variance;  ///< 1 channel: the part of relative_mse that is variance; the rest is bias.
  Image relative_noise;     ///< 1 channel: mean over RGB of the input's noise variance / (yhat^2 + 0.01). Empty if the
                            ///< map was read from a file without it.
  Image prior_share;        ///< 1 channel: share of the prior in the result, 0 to 1. Empty where no prior was mixed.
  double mean_relative_mse = 0;  ///< Mean of relative_mse over all pixels.
};

}  // namespace polyrecon
