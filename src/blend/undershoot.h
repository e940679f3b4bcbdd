#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// Raises values that a polynomial let fall below every noisy input within 2 pixels: in a dark corner beside a bright
/// wall it would else turn negative. From above there is only that of the noise (blend/noise_bound.h), since the
/// light may come in spikes that no sample here has met. input: the noisy colours, channels as in image: beauty, then
/// colour layers of 3 channels each. A layer is raised by its share of the beauty around (the ratio of their sums over
/// the same pixels), so that layers that add up still do; a last single channel (alpha) is left alone. Returns how many
/// pixels were raised.
std::size_t raise_undershoot(const Image& input, Image& image);

}  // namespace polyrecon
