#pragma once

#include <cstddef>

#include "blend/select.h"
#include "core/half_pair.h"
#include "polyrecon/frame.h"

namespace polyrecon {

/// A denoised layer of the file, made usable; 3 channels each.
struct CorrectedPrior {
  Image value;
  Image sharpening;  ///< What was added to make it as sharp as our own result, part of value.
};

/// Channels that the corrections by a prior hold, but for the tiles of select_correction: the corrected prior, and the
/// beauty of both halves before and after.
constexpr std::size_t prior_work_channels = 2 * 3 + 2 * 3 + 2 * 3;

/// What a denoised layer of the file says of the beauty: the mean of its halves where it has them (their noise is
/// averaged), else its mean. Each channel is brought to the sum of the noisy halves where that takes a factor of 1/2 to
/// 2: noise hardly moves a sum over the frame, so what differs is the prior's exposure. Pixels that are not usable, and
/// all of a prior without a usable one, take the value of own. Last, a blurred one is sharpened (blend/sharpen.h).
/// 3 channels; prior is not empty and of the pair's size.
CorrectedPrior correct_prior(Pass prior, const HalfPair& pair, const Image& own);

/// How much of the input's noise the prior holds, 1 if it is the input itself: slope of its difference from own over
/// the input's, relative to the brightest of the three. An upper bound, since detail that own misses counts too. All 3
/// channels.
double noise_in_prior(const Image& prior, const HalfPair& pair, const Image& own);

/// Order -1 of equation (2): takes the prior as it is, whole or in part, where that has less error. own and own + s b
/// (prior - own), s = 0.5, 0.6 .. 1, are judged by cross-validation like any others. b is how far each is believed,
///     exp(-max(0, D / E - 2)),   D = its squared distance from own + (2 s sharpening)^2,   E = mse,
/// both relative and averaged over risk_sigma: an image that contradicts the samples by far more than our own
/// estimated error is wrong, whatever the noise of the validation lets it score; and what had to be sharpened may be
/// wrong by twice what that changed. mse: estimated squared error of own (ErrorMap::mse). Only the beauty changes;
/// bias, variance and order stay those of own. max_bytes: as in select_correction.
Candidate add_prior(const HalfPair& pair, const CorrectedPrior& prior, const Image& mse, Candidate own,
                    const SelectParams& params, std::size_t max_bytes);

}  // namespace polyrecon
