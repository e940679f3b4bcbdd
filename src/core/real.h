#pragma once

#include <algorithm>
#include <limits>

#include "polyrecon/image.h"

namespace polyrecon {

/// Largest relative error of rounding to a half float.
constexpr double half_float_rounding = 0x1p-11;

/// Converts a value to a sample; values above the largest finite sample become that.
inline Real storable(double value) {
  constexpr double most = std::numeric_limits<Real>::max();
  return static_cast<Real>(std::min(value, most));
}

}  // namespace polyrecon
