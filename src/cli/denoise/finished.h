#pragma once

#include <string>

#include "cli/denoise/job.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// The files that the result of a frame is made from: the identity (io/file_identity.h) of each one, including those of
/// the neighbours in time that exist. The result contains it as polyrecon/input.
std::string input_identity(const Job& job, const FrameFiles& files, const FrameSource& source);

/// Whether all outputs of a frame exist and decode, and the picture was made from the same input, by the same settings
/// and by this version of the program. Throws as read_frame_header where the input cannot be read.
bool is_finished(const Job& job, const FrameFiles& files);

}  // namespace polyrecon
