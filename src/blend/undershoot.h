#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// Raises values that a polynomial put below every noisy input within 2 pixels; in a dark corner next to a bright wall
/// such a value could even be negative. There is no such limit from above (but see blend/noise_bound.h), since the
/// energy may come in spikes that no sample near the pixel has hit. An AOV is raised in proportion to its share of the
/// beauty, the ratio of their sums over the same pixels, so that layers that add up to the beauty still do; alpha stays
/// unchanged. Returns the number of raised pixels.
/// input: the noisy colours, channels as in image (ColorLayout).
std::size_t raise_undershoot(const Image& input, Image& image);

}  // namespace polyrecon
