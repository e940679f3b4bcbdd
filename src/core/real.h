#pragma once

#include <algorithm>
#include <limits>

#include "polyrecon/image.h"

namespace polyrecon {

/// Relative error of rounding to a half float, at most.
constexpr double half_float_rounding = 0x1p-11;

/// A value as it is stored; what is greater than the greatest finite sample becomes that one.
inline Real storable(double value) {
  constexpr double most = std::numeric_limits<Real>::max();
  return static_cast<Real>(std::min(value, most));
}

}  // namespace polyrecon
