#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// How far a fit may differ from the noisy input of a pixel before it counts less there: the square of 5 standard
/// deviations of a half's noise, summed over the colours, radiance squared, 1 channel. The standard deviation is that
/// of the pixel, or if that is larger the least mean standard deviation of all squares of 7 x 7 pixels that contain the
/// pixel. So a pixel next to a glint, with little noise on one side and without the glint in either half, hardly counts
/// windows that cover both; a pixel among spikes may receive their energy, though no spike has hit it yet. variance: of
/// a half's noise as measured, before variance_floor.h raises it; 3 channels, >= 0.
Image noise_bound(const Image& variance);

}  // namespace polyrecon
