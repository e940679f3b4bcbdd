#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// What single bright pixels add to a noise variance that knows regions only, by channel: half of the square by which a
/// pixel exceeds all but one of its eight neighbours, so that a line is no spike. Spikes of noise come in numbers, a
/// glint stands alone: none counts for more than the fourth highest among the blocks of 5 x 5 pixels within two blocks
/// of its own. Beyond the border the nearest
/// pixel counts. Rounding to half floats makes no spikes. radiance: finite. Returns radiance squared, >= 0, of
/// radiance's shape.
Image spike_variance(const Image& radiance);

}  // namespace polyrecon
