#pragma once

#include <cstddef>
#include <vector>

#include "io/merge/render.h"

namespace polyrecon {

/// Sets the windows and regions of the renders. Throws Error{BadInput} where they cover more than max_pixels together,
/// or where a beauty cannot be read, Error{Missing} where one has no beauty.
void place_renders(std::vector<Render>& renders, std::size_t max_pixels);

}  // namespace polyrecon
