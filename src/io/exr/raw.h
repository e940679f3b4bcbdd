#pragma once

#include <string>

namespace polyrecon {

/// Whether a part of two EXR files with the same layout holds the same packed bytes in every chunk: scanlines, tiles of
/// all levels, deep data too. Throws std::runtime_error where a chunk cannot be read.
bool same_chunks(const std::string& path_a, const std::string& path_b, int part);

}  // namespace polyrecon
