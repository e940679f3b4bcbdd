#pragma once

#include <array>
#include <cstddef>

// The corner of the spectrum: the highest frequencies along both axes, where white noise stands and where a picture
// that a pixel filter has band-limited has next to nothing.
namespace polyrecon {

/// The filter along one axis. A place of the corner is the second of the four pixels.
constexpr std::array<double, 4> corner_taps{1, -3, 3, -1};

/// Sum of the squares of the taps: the corner of white noise has this many times its standard deviation.
constexpr double corner_gain = 20;

/// The corner at a place; value(i, j) is the pixel i to the right of it and j below, each from -1 to 2.
template <typename Value>
double corner_of_spectrum(const Value& value) {
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += corner_taps[static_cast<std::size_t>(i)] * corner_taps[static_cast<std::size_t>(j)] * value(i - 1, j - 1);
  return sum;
}

}  // namespace polyrecon
