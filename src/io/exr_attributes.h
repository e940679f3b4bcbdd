#pragma once

#include <OpenEXR/ImfAttribute.h>

#include <string>

namespace polyrecon {

/// An attribute's value as one line of text; empty for types without a short one.
std::string attribute_text(const Imf::Attribute& attribute);

/// text up to its first line break: library messages go into one-line errors.
std::string first_line(const std::string& text);

}  // namespace polyrecon
