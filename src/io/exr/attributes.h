#pragma once

#include <OpenEXR/ImfAttribute.h>

#include <string>

namespace polyrecon {

/// An attribute's value as one line of text; empty for types without a short one.
std::string attribute_text(const Imf::Attribute& attribute);

}  // namespace polyrecon
