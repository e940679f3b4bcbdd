#pragma once

#include <string>

namespace polyrecon {

/// Whether parts of the same layout in two EXR files hold the same packed bytes in every chunk: scanlines, tiles of
/// all levels, deep data too. Throws std::runtime_error where a chunk cannot be read.
bool same_chunks(const std::string& path_a, int part_a, const std::string& path_b, int part_b);

}  // namespace polyrecon
