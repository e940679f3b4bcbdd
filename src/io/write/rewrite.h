#pragma once

#include <string>
#include <vector>

#include "polyrecon/layers.h"
#include "polyrecon/write_result.h"

namespace polyrecon {

/// Writes an EXR file again with layers replaced, as write_result does. Returns its notes.
std::vector<std::string> rewrite_file(const FrameSource& source, const std::vector<Replacement>& replacements,
                                      const std::string& target, const WriteOptions& options);

}  // namespace polyrecon
