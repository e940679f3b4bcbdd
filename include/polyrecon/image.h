// Images and rectangles of pixels.
#pragma once

#include <cstddef>
#include <vector>

namespace polyrecon {

/// Type of stored samples: float, or double if the library was built with -DPOLYRECON_REAL=double. Sums are double.
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

/// A planar image: channels() planes of height() rows of width() samples, without padding. A default-constructed image
/// is empty and stands for a missing pass.
class Image {
 public:
  Image() = default;
  /// All sizes at least 0; every sample has the value fill.
  Image(int width, int height, int channels, Real fill = 0);

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  bool empty() const { return samples_.empty(); }
  Rect bounds() const { return {0, 0, width_, height_}; }
  /// Number of pixels; also the number of samples from one plane to the next.
  std::size_t pixels() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
  /// Place of column x, row y in a plane.
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

/// A copy of the part r, which must lie inside the image's bounds. The crop of an empty image is empty.
Image crop(const Image& image, const Rect& r);
/// The same with channels first to first + count - 1 only.
Image crop(const Image& image, const Rect& r, int first, int count);

/// Copies the part `from` of source into target so that its upper left pixel lands on (x, y). Both have the same number
/// of channels; the part must fit into target.
void paste(const Image& source, const Rect& from, Image& target, int x, int y);

}  // namespace polyrecon
