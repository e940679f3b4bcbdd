#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// The variance of single bright pixels, per channel, for use with a noise variance that was estimated over regions and
/// so misses them. A spike exceeds all but one of its eight neighbours (so a line is not a spike); its variance is half
/// of the square of this excess. Spikes of noise are numerous and a glint of the scene is not, so the variance is
/// limited to the fourth highest of the maxima of the 5 x 5 pixel blocks within two blocks of the pixel's block.
/// Border pixels are repeated outside the image. An excess that rounding to half floats explains is ignored.
/// radiance: finite. Returns radiance squared, >= 0, of radiance's shape.
Image spike_variance(const Image& radiance);

}  // namespace polyrecon
