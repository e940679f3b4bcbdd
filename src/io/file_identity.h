#pragma once

#include <string>

namespace polyrecon {

/// Name without folder, length and checksum of a file: "shot.0001.exr, 81234 bytes, xxh64 01ab...". The identity does
/// not depend on the folder or the time of the file. Throws Error{Missing} if there is no such file, Error{BadInput} if
/// it cannot be read.
std::string file_identity(const std::string& path);

}  // namespace polyrecon
