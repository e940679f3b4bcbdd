#pragma once

#include <vector>

#include "cli/common/progress_output.h"
#include "cli/denoise/denoise_options.h"
#include "cli/denoise/frame_files.h"

namespace polyrecon {

/// Works the frames in order; the next one is read while this one is computed. A frame that is missing, damaged or
/// cannot be reconstructed is reported and left out, the others go on: at the end Error{Missing} lists such frames.
/// Errors that will meet the next frame too (output, use, a signal) end the work at once, as every error does with
/// --strict.
void run_sequence(const std::vector<FrameFiles>& frames, const DenoiseOptions& options, RunProgress& progress);

/// Says what run_sequence would do, from the headers of the files alone; ends as it would.
void show_dry_run(const std::vector<FrameFiles>& frames, const DenoiseOptions& options);

}  // namespace polyrecon
