#pragma once

#include <string>
#include <vector>

#include "cli/denoise/file_run.h"
#include "cli/denoise/job.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// Writes the file of all pictures and the maps of each. Returns notes about them. Throws as write_result.
std::vector<std::string> write_outputs(const Job& job, const FrameFiles& files,
                                       const std::vector<DonePicture>& pictures, Progress& progress);

}  // namespace polyrecon
