#pragma once

#include <string>

#include "polyrecon/image.h"

namespace polyrecon {

/// Writes rgb (3 channels, 0..1) with 8 bits a channel as JPEG or TIFF where the ending of target is theirs, else as
/// PNG. The file takes its name only once it is whole. Throws Error{CannotWrite}; an older file is then untouched.
void write_picture(const std::string& target, const Image& rgb);

}  // namespace polyrecon
