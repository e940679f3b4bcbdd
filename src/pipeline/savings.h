#pragma once

#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// Whether pixels without noise (or with too little to matter) are left alone, and how much of the frame they are.
Decision decide_on_pixels(double skipped, const Params& params);

/// Fills Decision::saved_seconds, about: what the polynomials would have taken on the pixels and features left out, by
/// what they took on the others, and what cleaning clean passes would have taken, by a block of the frame that is
/// cleaned here and timed (a few milliseconds). skipped: share of the frame; polynomials: seconds.
void estimate_savings(const Frame& frame, const PrefilterParams& prefilter_params, double skipped, double polynomials,
                      std::vector<Decision>& decisions);

}  // namespace polyrecon
