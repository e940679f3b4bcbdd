#pragma once

#include <cstddef>
#include <vector>

namespace polyrecon {

/// Type of stored samples, chosen when the project is configured (POLYRECON_REAL). Sums are always double.
using Real = POLYRECON_REAL;

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

/// A planar image: channels() planes, each height() rows of width() samples, rows without padding.
/// A default-constructed Image is empty and stands for "this pass is not there".
class Image {
 public:
  Image() = default;
  Image(int width, int height, int channels, Real fill = 0);

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  bool empty() const { return samples_.empty(); }
  Rect bounds() const { return {0, 0, width_, height_}; }
  /// Number of pixels, and so the distance between two planes.
  std::size_t pixels() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  Real* plane(int c) { return samples_.data() + static_cast<std::size_t>(c) * pixels(); }
  const Real* plane(int c) const { return samples_.data() + static_cast<std::size_t>(c) * pixels(); }
  Real* row(int c, int y) { return plane(c) + index(0, y); }
  const Real* row(int c, int y) const { return plane(c) + index(0, y); }
  Real& at(int x, int y, int c) { return plane(c)[index(x, y)]; }
  Real at(int x, int y, int c) const { return plane(c)[index(x, y)]; }

  bool same_shape(const Image& other) const {
    return width_ == other.width_ && height_ == other.height_ && channels_ == other.channels_;
  }

 private:
  int width_ = 0, height_ = 0, channels_ = 0;
  std::vector<Real> samples_;
};

/// The part of image inside r, which must lie within its bounds. An empty image stays empty.
Image crop(const Image& image, const Rect& r);
/// The same of channels first to first + count - 1.
Image crop(const Image& image, const Rect& r, int first, int count);

/// Copies the part `from` of source to the place (x, y) of target; same number of channels.
void paste(const Image& source, const Rect& from, Image& target, int x, int y);

}  // namespace polyrecon
