#pragma once

#include <string>

namespace polyrecon {

/// Decodes every flat part of an EXR file, band by band, and throws the pixels away: a file that passes can be read.
/// Throws Error{Missing} where there is no such file, Error{BadInput} where it is damaged.
void decode_file(const std::string& path);

}  // namespace polyrecon
