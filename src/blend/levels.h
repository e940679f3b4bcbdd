#pragma once

#include <cstddef>

#include "blend/select.h"
#include "core/half_pair.h"

namespace polyrecon {

/// The pair at half the resolution, each pixel the mean of 2 x 2, with a quarter of the noise variance.
HalfPair downsample(const HalfPair& pair);

/// Adds the low-frequency remainder that a window of limited radius leaves where the noise is strong. With u =
/// up(coarse - down(fine)), the candidates fine, fine + u/2 and fine + u are judged by cross-validation like any
/// others. coarse: a result on downsample(pair). bias, variance and order are those of fine.
/// max_bytes: as in select_correction.
Candidate add_coarse(const HalfPair& pair, Candidate fine, const Candidate& coarse, const SelectParams& params,
                     std::size_t max_bytes);

}  // namespace polyrecon
