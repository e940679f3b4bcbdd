#pragma once

#include <cstddef>

#include "blend/select.h"
#include "core/color_layout.h"
#include "core/half_pair.h"
#include "polyrecon/frame.h"

namespace polyrecon {

/// The prior, a picture that another denoiser made, after its correction; 3 channels each.
struct CorrectedPrior {
  Image value;
  Image sharpening;  ///< The part of value that sharpen_to added.
};

/// Channels that add_prior holds in addition to the tiles of select_correction: the corrected prior, and the beauty of
/// both halves before and after.
constexpr std::size_t prior_candidate_channels = std::size_t{3} * 2 * std::size_t{ColorLayout::primaries};

/// Prepares a prior for add_prior. It is the mean of the pass's halves where it has them (which averages their noise),
/// else its mean.
/// - It is brought to the exposure of the pair (prior/exposure.h), with the reconstruction as fallback.
/// - A blurred prior is sharpened (prior/sharpen.h).
/// prior: not empty, of the pair's size.
/// reconstruction: the mean of the halves of the result so far, 3 channels.
CorrectedPrior correct_prior(Pass prior, const HalfPair& pair, const Image& reconstruction);

/// Part of the input's noise that the prior holds: 0 for a prior without it, 1 for the input itself. Computed as the
/// slope of the prior's difference from the reconstruction on the input's difference from it, relative to the brightest
/// of the three. This is an upper bound, since detail that the reconstruction misses counts as noise. All images have 3
/// channels.
double noise_in_prior(const Image& prior, const HalfPair& pair, const Image& reconstruction);

/// Order -1 of equation (2): uses the prior, whole or in part, where it has less error than the result so far, f.
/// Selects by cross-validation among f and f + s b (prior - f) for s = 0.5, 0.6 .. 1. b is the trust in the prior,
///     b = exp(-max(0, D / E - 2)),   D = |prior - f|^2 + (2 s sharpening)^2,   E = mse,
/// with D and E relative and averaged over risk_sigma. A prior that differs from f by far more than the estimated error
/// of f is wrong, whatever the noise of the validation lets it score; and sharpening may be wrong by twice what it
/// changed. Only the beauty changes; bias, variance and order of the result are those of f.
/// mse: estimated squared error of f (ErrorMap::mse).
/// max_bytes: as in select_correction.
Candidate add_prior(const HalfPair& pair, const CorrectedPrior& prior, const Image& mse, Candidate result,
                    const SelectParams& params, std::size_t max_bytes);

}  // namespace polyrecon
