#pragma once

#include <optional>
#include <string>

#include "polyrecon/encoding.h"

namespace polyrecon {

/// The name of a compression by its number in the file: "none", "zip", ...; also of those of later releases of OpenEXR
/// than the one of this build. Empty for other numbers.
std::string compression_name(int number);

/// The compression of a name; nothing for another text.
std::optional<Compression> compression_from(const std::string& name);

/// Why this build cannot read pixels of a compression that has a name, and what to do; empty where it can.
std::string compression_obstacle(int number);

}  // namespace polyrecon
