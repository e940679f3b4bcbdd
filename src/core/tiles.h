#pragma once

#include <vector>

#include "core/rect.h"

namespace polyrecon {

/// A part of an image worked on its own: core is what it answers for, padded what it has to see.
struct Tile {
  Rect core, padded;
};

/// The core in coordinates of the padded part.
Rect inside(const Tile& tile);

/// Cuts bounds into tiles whose padded area has at most max_pixels pixels where possible (at least one alignment x
/// alignment core each). Padded areas begin at multiples of alignment and reach halo pixels beyond the core, cut to
/// bounds.
std::vector<Tile> make_tiles(const Rect& bounds, int halo, int alignment, std::size_t max_pixels);

}  // namespace polyrecon
