#pragma once

#include <algorithm>

namespace polyrecon {

/// The correlation of the noise of pixels next to each other that a pixel filter makes, from a measured one: 0 where it
/// is less than that of a tent, the narrowest filter but a box (0.25; boxes are measured as up to 0.05), and at most
/// 0.5, as wider filters blur the picture.
inline double filter_correlation(double measured) {
  constexpr double least = 0.15, most = 0.5;
  return measured < least ? 0 : std::min(measured, most);
}

}  // namespace polyrecon
