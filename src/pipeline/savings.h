#pragma once

#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// The decision whether pixels without noise, or with not more than Params::enough, are skipped. skipped: their share
/// of the frame, 0..1.
Decision decide_on_pixels(double skipped, const Params& params);

/// Estimates Decision::saved_seconds: the time that fits would have taken for skipped pixels and unused features, from
/// the time of the fits that were made, and that the prefilter would have taken for features without noise, from the
/// time for a block of the frame, which is filtered here (a few milliseconds). skipped: share of the frame.
/// polynomials: seconds that the fits took.
void estimate_savings(const Frame& frame, const PrefilterParams& prefilter_params, double skipped, double polynomials,
                      std::vector<Decision>& decisions);

}  // namespace polyrecon
