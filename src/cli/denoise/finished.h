#pragma once

#include <string>

#include "cli/denoise/job.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// Whether all outputs of a frame exist and decode, and the picture was made from the same input, by the same settings
/// and by this version of the program. Throws as read_frame_header where the input cannot be read.
bool is_finished(const Job& job, const FrameFiles& files);

}  // namespace polyrecon
