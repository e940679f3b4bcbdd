#pragma once

#include <algorithm>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

inline Rect intersect(const Rect& a, const Rect& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

/// The smallest rectangle that contains both; an empty one contributes nothing.
inline Rect bounding(const Rect& a, const Rect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

/// r extended by n pixels on every side.
inline Rect grow(const Rect& r, int n) { return {r.x0 - n, r.y0 - n, r.x1 + n, r.y1 + n}; }

/// The blocks of size x size pixels, aligned to multiples of size, that cover area, row by row and each cut to area.
/// The alignment does not depend on where area begins, so a tile has the same blocks as the whole frame.
std::vector<Rect> aligned_blocks(const Rect& area, int size);

}  // namespace polyrecon
