#pragma once

#include <string>

namespace polyrecon {

/// The name of a compression by its number in the file: "none", "zip", ...; also of those of later releases of OpenEXR
/// than the one of this build. Empty for other numbers.
std::string compression_name(int number);

/// Why this build cannot read pixels of a compression that has a name, and what to do; empty where it can.
std::string compression_obstacle(int number);

}  // namespace polyrecon
