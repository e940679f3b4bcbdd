#pragma once

#include <cstddef>

#include "blend/select.h"
#include "core/half_pair.h"

namespace polyrecon {

/// The pair at half the resolution: each pixel is the mean of 2 x 2 pixels and has a quarter of their noise variance.
HalfPair downsample(const HalfPair& pair);

/// Corrects the low-frequency noise that a window of limited radius leaves where the noise is strong. With
/// u = up(coarse - down(fine)), selects among fine, fine + u/2 and fine + u by cross-validation. Bias, variance and
/// order of the result are those of fine. coarse: a result on downsample(pair). max_bytes: as in select_correction.
Candidate add_coarse(const HalfPair& pair, Candidate fine, const Candidate& coarse, const SelectParams& params,
                     std::size_t max_bytes);

}  // namespace polyrecon
