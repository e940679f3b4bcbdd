#pragma once

#include "core/candidate.h"
#include "core/half_pair.h"
#include "polyrecon/error_map.h"

namespace polyrecon {

/// Channels of an ErrorMap with all its images.
constexpr std::size_t error_map_channels = 3 + 1 + 1 + 1;

/// The error map of a result, all terms over (yhat^2 + 0.01):
///     min(bias^2 + variance, noise)
/// with bias^2 the windows' (5) as they blend into the result (BlendedFit); variance (f_A - f_B)^2 / 4, which knows
/// that windows average each other's noise away; noise that of the input's mean: the input itself is among the
/// candidates, so a pixel that claims more than it has seen a firefly's window. Variance and noise, which single pixels
/// do not tell well, are averaged by a Gaussian of 2 pixels. variance: of the mean's noise as it was measured
/// (HalfPair's has a floor); where it is negative or no number, HalfPair's stands in.
ErrorMap make_error_map(const HalfPair& pair, const Image& variance, const Candidate& result);

}  // namespace polyrecon
