#pragma once

#include "cli/common/progress_output.h"
#include "cli/denoise/job.h"
#include "polyrecon/error.h"

namespace polyrecon {

/// Whether an error with this code concerns one frame, so that the next one may still succeed.
bool concerns_one_frame(ExitCode code);

/// Denoises the frames of a job in order; the next one is read while one is computed. A frame that is missing, damaged
/// or cannot be reconstructed is reported and left out, and the others are still denoised; at the end Error{Missing}
/// lists such frames. An error that concerns all frames (an output, wrong use, a signal) ends the run at once, and so
/// does any error with --strict. Returns whether a frame missed a limit.
bool run_sequence(const Job& job, RunProgress& progress);

/// Prints what a run would do, from the headers of the files alone, and throws as run_sequence.
void show_dry_run(const Job& job);

}  // namespace polyrecon
