#pragma once

#include <OpenEXR/ImfHeader.h>

#include <string>
#include <vector>

namespace polyrecon {

/// Tries out whether a file with these headers, which are those of the input `path`, can be written. OpenEXR reads some
/// headers that it refuses to write. Throws Error{BadInput}.
void require_writable(const std::string& path, const std::vector<Imf::Header>& headers);

}  // namespace polyrecon
