#pragma once

#include <string>
#include <vector>

#include "io/files/file.h"

namespace polyrecon {

/// Sets the one part of a PFM, Radiance or TIFF file, as file.format says: "pnm", "hdr" or "tiff". Channels are named
/// R, G, B, A or Y. Throws Error{BadInput} as describe_file does.
void describe_plain_image(FileInfo& file, const ReadLimits& limits);

/// Reads channels of the whole image. The upper row comes first, whatever the order in the file. Throws
/// Error{BadInput}.
Image read_plain_image(const FileInfo& file, const std::vector<std::string>& channels);

}  // namespace polyrecon
