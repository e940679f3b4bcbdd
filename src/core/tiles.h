#pragma once

#include <vector>

#include "core/rect.h"

namespace polyrecon {

/// A part of an image that is processed separately.
struct Tile {
  Rect core;    ///< The pixels whose result comes from this tile.
  Rect padded;  ///< The core and the pixels around it that the result depends on.
};

/// The core in coordinates of the padded area.
Rect inside(const Tile& tile);

/// Cuts bounds into tiles whose padded areas have at most max_pixels pixels; where that is too little, cores have
/// alignment x alignment pixels. Cores and padded areas begin at multiples of alignment. A padded area extends at least
/// `halo` pixels beyond the core, but not beyond bounds.
std::vector<Tile> make_tiles(const Rect& bounds, int halo, int alignment, std::size_t max_pixels);

}  // namespace polyrecon
