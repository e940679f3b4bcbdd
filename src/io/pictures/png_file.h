#pragma once

#include <string>

#include "polyrecon/image.h"

namespace polyrecon {

/// Writes rgb (3 channels, 0..1) as 8-bit PNG; the file takes its name only once it is whole.
/// Throws Error{CannotWrite}; an older file is then untouched.
void write_png(const std::string& target, const Image& rgb);

}  // namespace polyrecon
