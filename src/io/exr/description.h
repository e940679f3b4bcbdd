#pragma once

#include "polyrecon/file_info.h"

namespace polyrecon {

/// Sets the format and the parts of an EXR file, whose path and length are set. Headers are read whole, and the file is
/// checked against them (io/exr/guard.h). Throws Error{BadInput} as describe_file does.
void describe_exr(FileInfo& file, const ReadLimits& limits);

}  // namespace polyrecon
