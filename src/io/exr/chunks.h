#pragma once

#include <OpenEXR/ImfHeader.h>

#include <cstdint>
#include <string>
#include <vector>

namespace polyrecon {

/// Chunks of a part: blocks of scanlines, or tiles of all levels.
std::uint64_t chunk_count(const Imf::Header& header);

/// Looks at every chunk without decoding it: its offset in the tables that begin at table_begin, its part, and that the
/// bytes it claims are in the file. Throws Error{BadInput}: "not yet rendered" where no chunk was written, else
/// "incomplete" naming part and scanlines or tile of the first that is missing or cut.
void check_chunks(const std::string& path, std::uint64_t file_bytes, std::uint64_t table_begin,
                  const std::vector<Imf::Header>& headers);

/// Pixels from the first to the last of a window, which may lie anywhere in the range of int.
inline std::uint64_t window_side(int first, int last) {
  return static_cast<std::uint64_t>(std::int64_t{last} - first + 1);
}

/// Whether a part is stored in tiles.
bool is_tiled_part(const Imf::Header& header);

}  // namespace polyrecon
