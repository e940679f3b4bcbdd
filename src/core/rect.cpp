#include "core/rect.h"

namespace polyrecon {
namespace {

int floor_to_multiple(int value, int size) {
  const int remainder = value % size;
  return value - (remainder < 0 ? remainder + size : remainder);
}

}  // namespace

std::vector<Rect> aligned_blocks(const Rect& area, int size) {
  std::vector<Rect> blocks;
  if (area.empty()) return blocks;
  for (int y = floor_to_multiple(area.y0, size); y < area.y1; y += size)
    for (int x = floor_to_multiple(area.x0, size); x < area.x1; x += size)
      blocks.push_back(intersect(area, {x, y, x + size, y + size}));
  return blocks;
}

}  // namespace polyrecon
