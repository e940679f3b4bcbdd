#pragma once

#include "core/candidate.h"
#include "core/half_pair.h"
#include "polyrecon/error_map.h"

namespace polyrecon {

/// Estimates the error of a result. Per channel, with all terms relative to relmse_denominator(yhat),
///     error = min(bias^2 + variance, noise).
/// - bias^2 is that of the windows (5), blended into the result (BlendedFit).
/// - variance is that of the mean of the result's halves, (f_A - f_B)^2 / 4, which includes that windows average out
///   each other's noise.
/// - noise is the noise variance of the input's mean. The input is one of the candidates, so a pixel whose estimate
///   exceeds its noise was contaminated by a firefly's window, and the estimate is clamped.
/// Variance and noise of single pixels are unreliable and so are averaged by a Gaussian of 2 pixels.
/// variance: of the mean's noise as measured (HalfPair::variance has a floor), 3 channels. Where it is negative or not
/// finite, HalfPair::variance is used.
/// rendered: mask of the pixels that are not void; the others have no error.
ErrorMap make_error_map(const HalfPair& pair, const Image& variance, const Candidate& result,
                        const Image& rendered = {});

/// The error of the mix, from that of the reconstruction f. For the best share w, the error of the mix is that of f
/// less (1 - w)^2 (f - prior)^2, by Pythagoras; half of it is subtracted, as the share is not known exactly, and at
/// least a quarter of the error stays. The difference is averaged by a Gaussian of 2 pixels.
void lower_error(const Image& reconstruction, const Image& prior, const Image& share, const Image& sampled,
                 ErrorMap& error);

}  // namespace polyrecon
