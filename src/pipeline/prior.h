#pragma once

#include <cstddef>
#include <vector>

#include "blend/mix_prior.h"
#include "core/candidate.h"
#include "core/half_pair.h"
#include "features/prepare.h"
#include "polyrecon/denoiser.h"
#include "polyrecon/error_map.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"
#include "polyrecon/report.h"

// Priors: pictures of another denoiser, read from a file or made in this process, in the order of a reconstruction.
namespace polyrecon {

/// Copies the features for a denoiser before `prepare` takes them out of the frame.
DenoiserFeatures denoiser_features(const Frame& frame);

/// The prior that a denoiser makes of the noisy halves (denoisers/denoise_frame.h). features: noisy, of the frame; they
/// are used if params.denoiser.clean_features. uses: the features of the fits.
Pass make_prior(const Denoiser& denoiser, DenoiserFeatures features, const std::vector<FeatureUse>& uses,
                const Prepared& prepared, const DenoiserParams& params, std::size_t max_bytes, Progress& progress);

/// Units of work of make_prior.
std::size_t make_prior_units(const Prepared& prepared, const DenoiserParams& params);

/// A prior that is ready to be mixed into a result.
struct ReadyPrior {
  Pass pass;
  bool made_here = false;  ///< By a denoiser in this process, of this very frame.
  bool judged = false;     ///< Its halves are of independent samples, so that each is judged by the other half.
  HonestHalves judge;      ///< By judge_prior; empty where it is not judged.
};

ReadyPrior ready_prior(Pass prior, bool made_here, const Prepared& prepared);

/// The halves of a prior in the exposure of the frame, and the halves of the frame, each reconstructed by itself: at
/// draft quality in two stages, after it was split anew (noise/fission.h). Takes the halves out of the prior.
HonestHalves judge_prior(Pass& prior, const HalfPair& pair, const Params& params, std::size_t max_bytes,
                         Progress& progress);

/// Units of work of judge_prior.
std::size_t judge_units(const HalfPair& pair);

/// Channels that judge_prior holds in addition to the pair, the prior, its result and tiles.
std::size_t judge_channels(std::size_t feature_channels);

/// Takes a prior into a result, and notes what was decided. A prior with a judge is mixed in by what its halves show
/// (reconstruction_share); one that was made here without a judge leads (unjudged_share); any other one is a candidate
/// (blend/prior.h) unless it is the noisy input itself. reconstruction: the mean of the result's halves. error: that of
/// the result; becomes that of the mix.
Candidate use_prior(ReadyPrior prior, const HalfPair& pair, const Image& reconstruction, const SelectParams& params,
                    std::size_t max_bytes, Candidate solved, ErrorMap& error, std::vector<Decision>& decisions);

}  // namespace polyrecon
