#pragma once

#include <string>

#include "cli/denoise/denoise_options.h"
#include "cli/denoise/frame_files.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// What the result of a frame was made from: the identity (io/file_identity.h) of every file that takes part, the
/// neighbours in time that are there among them; goes into the result as polyrecon/input.
std::string input_identity(const FrameFiles& files, const FrameSource& source);

/// Whether all outputs of a frame are there, decode, and the picture was made from the very input, with the same
/// settings and by this version of the program. Throws as read_frame_header does where the input cannot be read.
bool is_finished(const FrameFiles& files, const DenoiseOptions& options);

}  // namespace polyrecon
