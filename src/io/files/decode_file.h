#pragma once

#include <string>

namespace polyrecon {

/// Decodes every flat part of an EXR file, to find out whether the file can be read.
/// Throws Error{Missing} where there is no such file, Error{BadInput} where it is damaged.
void decode_file(const std::string& path);

}  // namespace polyrecon
