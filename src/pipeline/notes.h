#pragma once

#include <cstddef>
#include <vector>

#include "blend/blend_windows.h"
#include "features/prepare.h"
#include "outliers/outlier.h"
#include "pipeline/survey.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "polyrecon/reconstruct.h"
#include "polyrecon/report.h"
#include "temporal/join.h"

// The entries that the steps of a reconstruction make in its report.
namespace polyrecon {

/// The size and energy of the frame.
void note_input(const Frame& frame, Report& report);
void note_preparation(const Survey& survey, const Prepared& prepared, Report& report);
void note_outliers(const std::vector<Outlier>& outliers, const Steps& steps, Report& report);
void note_neighbours(const JoinCounts& counts, bool with_motion, Report& report);
void note_fits(const FitCounters& counters, Report& report);
/// Completes result.report once all images are final.
void note_result(Result& result);

}  // namespace polyrecon
