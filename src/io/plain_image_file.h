#pragma once

#include <string>
#include <vector>

#include "io/exr/file.h"

namespace polyrecon {

/// Fills in format and the one part of a PFM, Radiance or TIFF file: passes that some renderers write one to a file.
/// Channels are named R, G, B, A or Y. Throws Error{BadInput} as describe_file does.
void describe_plain_image(FileInfo& file, const ReadLimits& limits);

/// Channels of the whole image, upper row first whatever the format's order. Throws Error{BadInput}.
Image read_plain_image(const FileInfo& file, const std::vector<std::string>& channels);

}  // namespace polyrecon
