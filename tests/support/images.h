#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>

#include "polyrecon/image.h"

namespace polyrecon::test {

/// An image with the values f(x, y, c).
template <typename F>
Image image_of(int width, int height, int channels, const F& f) {
  Image out(width, height, channels);
  for (int c = 0; c < channels; ++c)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) out.at(x, y, c) = static_cast<Real>(f(x, y, c));
  return out;
}

inline bool same_bits(const Image& a, const Image& b) {
  if (!a.same_shape(b)) return false;
  const std::size_t n = a.pixels() * static_cast<std::size_t>(a.channels());
  return n == 0 || std::memcmp(a.plane(0), b.plane(0), n * sizeof(Real)) == 0;
}

inline double max_difference(const Image& a, const Image& b) {
  double worst = 0;
  for (int c = 0; c < a.channels(); ++c)
    for (std::size_t i = 0; i < a.pixels(); ++i) {
      const double d = std::abs(static_cast<double>(a.plane(c)[i]) - static_cast<double>(b.plane(c)[i]));
      worst = d <= worst ? worst : d;  // keeps a NaN
    }
  return worst;
}

inline double max_magnitude(const Image& a) {
  double worst = 0;
  for (int c = 0; c < a.channels(); ++c)
    for (std::size_t i = 0; i < a.pixels(); ++i) worst = std::max(worst, std::abs(static_cast<double>(a.plane(c)[i])));
  return worst;
}

inline bool all_finite(const Image& a) {
  for (int c = 0; c < a.channels(); ++c)
    for (std::size_t i = 0; i < a.pixels(); ++i)
      if (!std::isfinite(a.plane(c)[i])) return false;
  return true;
}

inline double sum_of(const Image& a, int c) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels(); ++i) sum += static_cast<double>(a.plane(c)[i]);
  return sum;
}

inline Image mean_of(const Image& a, const Image& b) {
  return image_of(a.width(), a.height(), a.channels(), [&](int x, int y, int c) {
    return (static_cast<double>(a.at(x, y, c)) + static_cast<double>(b.at(x, y, c))) / 2;
  });
}

/// The image with every sample multiplied by factor.
inline Image times(const Image& a, double factor) {
  return image_of(a.width(), a.height(), a.channels(),
                  [&](int x, int y, int c) { return static_cast<double>(a.at(x, y, c)) * factor; });
}

}  // namespace polyrecon::test
