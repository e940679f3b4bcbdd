#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace polyrecon {

/// A rectangle of pixels: columns x0 .. x1 - 1, rows y0 .. y1 - 1.
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  std::size_t area() const {
    return empty() ? 0 : static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }

  friend bool operator==(const Rect& a, const Rect& b) {
    return a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1;
  }
};

inline Rect intersect(const Rect& a, const Rect& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

/// r with a margin of n pixels added on every side.
inline Rect grow(const Rect& r, int n) { return {r.x0 - n, r.y0 - n, r.x1 + n, r.y1 + n}; }

/// The blocks of size x size pixels, aligned to multiples of size, that cover area; row by row, each cut to area.
/// Alignment does not depend on where area begins, so a tile sees the same blocks as the whole frame.
std::vector<Rect> aligned_blocks(const Rect& area, int size);

}  // namespace polyrecon
