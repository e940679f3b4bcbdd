#pragma once

#include <string>

#include "polyrecon/image.h"
#include "polyrecon/polyrecon.h"

namespace polyrecon {

/// An image in the memory of a caller, with strides.
using MemoryImage = polyrecon_image;

/// An image with its name, as users of the C interface get it.
struct NamedImage {
  std::string name;
  Image image;
};

/// Throws Error{Usage} if the description is invalid: no data, no pixels, more pixels than the program reads
/// (ReadLimits), some strides 0 and others not, an unknown format.
void check(const std::string& name, const MemoryImage& image);

/// The message for `other`, which must have the size of `image` and does not.
std::string size_conflict(const std::string& name, const Image& image, const MemoryImage& other);

/// Copies the samples. The description must have passed `check`.
Image read_memory(const MemoryImage& from);

/// Copies the samples of an image of the same size into memory that passed `check`. Half samples saturate.
void write_memory(const Image& image, const MemoryImage& to);

}  // namespace polyrecon
