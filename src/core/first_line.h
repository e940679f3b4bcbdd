#pragma once

#include <string>

namespace polyrecon {

/// The text up to its first line break. Messages of libraries may have several lines, those of Error have one.
inline std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace polyrecon
