#pragma once

#include <cstddef>
#include <vector>

#include "core/candidate.h"
#include "core/half_pair.h"
#include "features/prepare.h"
#include "polyrecon/denoiser.h"
#include "polyrecon/error_map.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"
#include "polyrecon/report.h"
#include "prior/mix.h"

// The steps of a reconstruction that concern a prior, the picture of another denoiser: making it in this process,
// validating it, and mixing it in.
namespace polyrecon {

/// Copies the features for a denoiser before `prepare` takes them out of the frame.
DenoiserFeatures denoiser_features(const Frame& frame);

/// The prior that a denoiser makes of the noisy halves (denoisers/denoise_frame.h). features: noisy, of the frame; they
/// are used if params.prefilter_features. uses: the features of the fits.
Pass make_prior(const Denoiser& denoiser, DenoiserFeatures features, const std::vector<FeatureUse>& uses,
                const Prepared& prepared, const DenoiserParams& params, std::size_t max_bytes, Progress& progress);

/// Units of work of make_prior.
std::size_t make_prior_units(const Prepared& prepared, const DenoiserParams& params);

/// A prior, and what is known about it before the fits.
struct ReadyPrior {
  Pass pass;
  bool made_here = false;       ///< By a denoiser in this process, of this very frame.
  bool validated = false;       ///< Its halves are of independent samples, so that each is validated by the other half.
  bool foreign_halves = false;  ///< Its halves are not of the render's (made_of_halves), so they validate nothing.
  ValidationHalves validation;  ///< By make_validation; empty unless validated.
};

ReadyPrior ready_prior(Pass prior, bool made_here, const Prepared& prepared);

/// The halves of a prior in the exposure of the frame, and the halves of the frame, each split once more
/// (noise/fission.h) and reconstructed alone, at draft quality in two stages, or one if the result has one. Takes the
/// halves out of the prior.
ValidationHalves make_validation(Pass& prior, const HalfPair& pair, const Params& params, std::size_t max_bytes,
                                 Progress& progress);

/// Units of work of make_validation.
std::size_t validation_units(const HalfPair& pair, const Params& params);

/// Channels that make_validation holds in addition to the pair, the prior, its result and tiles.
std::size_t validation_channels(std::size_t feature_channels);

/// Combines a prior with a result, and notes the decision. prior/mix.h mixes a validated prior by reconstruction_share,
/// and one that was made here without validation by unvalidated_share. Any other prior is a candidate
/// (prior/prior_candidate.h), unless it is the noisy input itself.
/// reconstruction: the mean of the result's halves. error: that of the result; becomes that of the mix.
Candidate use_prior(ReadyPrior prior, const HalfPair& pair, const Image& reconstruction, const SelectParams& params,
                    std::size_t max_bytes, Candidate solved, ErrorMap& error, std::vector<Decision>& decisions);

}  // namespace polyrecon
