#pragma once

#include <OpenEXR/ImfAttribute.h>
#include <OpenEXR/ImfHeader.h>

#include <string>

namespace polyrecon {

/// An attribute's value as one line of text; empty for types without a short one.
std::string attribute_text(const Imf::Attribute& attribute);

/// Sets an attribute of a header, of whatever type it was before.
void set_attribute(Imf::Header& header, const std::string& name, const Imf::Attribute& value);

}  // namespace polyrecon
