#pragma once

#include <string>
#include <vector>

namespace polyrecon {

/// The name that was probably meant by a mistyped one: few letters differ, or one begins with the other. Empty where
/// none is near.
std::string nearest(const std::string& typed, const std::vector<std::string>& names);

/// "; did you mean NAME?" where a name is near, else nothing.
std::string did_you_mean(const std::string& typed, const std::vector<std::string>& names);

}  // namespace polyrecon
