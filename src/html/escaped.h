#pragma once

#include <string>

namespace polyrecon {

/// Escapes text for HTML and SVG, also for the inside of attributes.
std::string escaped(const std::string& text);

}  // namespace polyrecon
