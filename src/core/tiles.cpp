#include "core/tiles.h"

#include <cmath>

#include "core/rect.h"

namespace polyrecon {

Rect inside(const Tile& tile) {
  const Rect &core = tile.core, &padded = tile.padded;
  return {core.x0 - padded.x0, core.y0 - padded.y0, core.x1 - padded.x0, core.y1 - padded.y0};
}

std::vector<Tile> make_tiles(const Rect& bounds, int halo, int alignment, std::size_t max_pixels) {
  if (bounds.area() <= max_pixels) return {{bounds, bounds}};
  const int margin = (halo + alignment - 1) / alignment * alignment;
  const int side = static_cast<int>(std::sqrt(static_cast<double>(max_pixels)));
  const int core = std::max((side - 2 * margin) / alignment * alignment, alignment);
  std::vector<Tile> tiles;
  for (const Rect& r : aligned_blocks(bounds, core)) tiles.push_back({r, intersect(grow(r, margin), bounds)});
  return tiles;
}

}  // namespace polyrecon
