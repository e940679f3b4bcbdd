#pragma once

#include <string>

namespace polyrecon {

/// Name (without its folder), length and checksum of a file's bytes: "shot.0001.exr, 81234 bytes, xxh64 01ab...". Two
/// files of one identity hold the same render, wherever they are and whenever they were copied. Throws Error{Missing}
/// where there is no such file, Error{BadInput} where it cannot be read.
std::string file_identity(const std::string& path);

}  // namespace polyrecon
