#pragma once

#include <string>
#include <vector>

#include "cli/denoise/job.h"
#include "polyrecon/progress.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {

/// Writes the picture and the maps of a frame. Returns notes about them. Throws as write_result.
std::vector<std::string> write_outputs(const Job& job, const FrameFiles& files, const ReadResult& in,
                                       const Result& result, Progress& progress);

}  // namespace polyrecon
