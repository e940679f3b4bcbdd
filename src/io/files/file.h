#pragma once

#include <string>
#include <vector>

#include "polyrecon/file_info.h"

namespace polyrecon {

struct Band;

/// Threads that decode and encode chunks in this process; 0: in the calling thread.
void set_codec_threads(int threads);

/// "part 2 "right"", with its name if it has one.
std::string title_of(const FileInfo& file, int part);

/// Decodes whole channels of one part: channels[c] becomes plane c, pixel (0, 0) is the data window's upper left
/// corner. Half and float values are kept as they are, NaN and Inf too; uint is converted. Reads every scanline or
/// tile. Throws Error{BadInput} naming the part and the first scanline or tile that cannot be read, Error{OutOfMemory}
/// where the image would be larger than limits.max_bytes.
Image read_channels(const FileInfo& file, int part, const std::vector<std::string>& channels,
                    const ReadLimits& limits = {});

/// The same, into planes of the caller: planes[c] has room for the data window's pixels. Does not look at max_bytes.
void read_planes(const FileInfo& file, int part, const std::vector<std::string>& channels,
                 const std::vector<Real*>& planes);

/// Copies the first channels of a band (io/files/channel_reader.h) into as many planes of the caller.
void copy_band(const Band& band, const std::vector<Real*>& planes);

}  // namespace polyrecon
