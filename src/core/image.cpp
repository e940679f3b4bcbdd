#include "core/image.h"

#include <algorithm>
#include <cassert>

namespace polyrecon {

Image::Image(int width, int height, int channels, Real fill) : width_(width), height_(height), channels_(channels) {
  assert(width >= 0 && height >= 0 && channels >= 0);
  samples_.assign(pixels() * static_cast<std::size_t>(channels), fill);
}

Image crop(const Image& image, const Rect& r) {
  if (image.empty()) return {};
  Image out(r.width(), r.height(), image.channels());
  paste(image, r, out, 0, 0);
  return out;
}

void paste(const Image& source, const Rect& from, Image& target, int x, int y) {
  assert(source.channels() == target.channels());
  assert(intersect(from, source.bounds()) == from);
  assert(x + from.width() <= target.width() && y + from.height() <= target.height());
  for (int c = 0; c < source.channels(); ++c)
    for (int row = 0; row < from.height(); ++row) {
      const Real* begin = source.row(c, from.y0 + row) + from.x0;
      std::copy(begin, begin + from.width(), target.row(c, y + row) + x);
    }
}

}  // namespace polyrecon
