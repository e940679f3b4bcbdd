#pragma once

#include <string>
#include <vector>

#include "io/merge/render.h"
#include "polyrecon/file_info.h"

namespace polyrecon {

/// Opens independent renders of one frame with the passes in files next to them, checks that they fit the first one,
/// and brings their layers into its order. notes: takes which passes are left out. Throws as merge (polyrecon/merge.h).
std::vector<Render> open_renders(const std::vector<std::string>& paths, const ReadLimits& limits,
                                 std::vector<std::string>& notes);

}  // namespace polyrecon
