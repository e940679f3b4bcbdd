#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/rect.h"
#include "io/exr/bands.h"
#include "polyrecon/file_info.h"

namespace polyrecon {

/// Copies what two rectangles of rows have in common within a third one. Elements are of `size` bytes.
void copy_common(const char* from, const Rect& source, char* to, const Rect& target, const Rect& within,
                 std::size_t size);

/// Reads channels of a part over an area: a plane for each, 0 outside the part's data window.
std::vector<float> read_area(const FileInfo& file, int part, const std::vector<std::string>& channels,
                             const Rect& area);

/// Copies of each sample that read_area holds at once: as decoded, and cut to the area.
constexpr std::size_t read_area_copies = 2;

Rect area_of(const NativeBand& band);

/// Sets sample i of a channel of floats.
void put(NativeChannel& channel, std::size_t i, double value);

}  // namespace polyrecon
