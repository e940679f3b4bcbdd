#include "polyrecon/image.h"

#include <algorithm>
#include <cassert>

#include "core/rect.h"

namespace polyrecon {

Image::Image(int width, int height, int channels, Real fill) : width_(width), height_(height), channels_(channels) {
  assert(width >= 0 && height >= 0 && channels >= 0);
  samples_.assign(pixels() * static_cast<std::size_t>(channels), fill);
}

namespace {

/// Copies channel `channel` of the part `from` of source to channel `to` of target, at (x, y).
void copy_plane(const Image& source, int channel, const Rect& from, Image& target, int to, int x, int y) {
  for (int row = 0; row < from.height(); ++row) {
    const Real* begin = source.row(channel, from.y0 + row) + from.x0;
    std::copy(begin, begin + from.width(), target.row(to, y + row) + x);
  }
}

}  // namespace

Image crop(const Image& image, const Rect& r) { return crop(image, r, 0, image.channels()); }

Image crop(const Image& image, const Rect& r, int first, int count) {
  assert(first >= 0 && first + count <= image.channels());
  if (image.empty()) return {};
  assert(intersect(r, image.bounds()) == r);
  Image out(r.width(), r.height(), count);
  for (int c = 0; c < count; ++c) copy_plane(image, first + c, r, out, c, 0, 0);
  return out;
}

void paste(const Image& source, const Rect& from, Image& target, int x, int y) {
  assert(source.channels() == target.channels());
  assert(intersect(from, source.bounds()) == from);
  assert(x + from.width() <= target.width() && y + from.height() <= target.height());
  for (int c = 0; c < source.channels(); ++c) copy_plane(source, c, from, target, c, x, y);
}

}  // namespace polyrecon
