#pragma once

#include "core/image.h"

namespace polyrecon {

/// The estimated error of a reconstruction: equation (4), blended over the windows like the image itself.
struct ErrorMap {
  Image mse;                ///< 3 channels: E[(yhat - mu)^2] per channel, radiance squared.
  Image relative_mse;       ///< 1 channel: mean over RGB of mse / (yhat^2 + 0.01).
  Image relative_variance;  ///< 1 channel: the part of relative_mse that falls as 1/n with n more samples; the rest is
                            ///< bias.
};

}  // namespace polyrecon
