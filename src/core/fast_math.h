#pragma once

#include <cstdint>
#include <cstring>

#include "core/real.h"

namespace polyrecon {

/// exp(-x) for x in [0, 80] with a relative error below 3e-7 (tests/core/fast_math_test.cpp), by Cody-Waite reduction
/// and a polynomial of degree 6. It is inline and without branches so that loops over it vectorise, which std::exp
/// prevents. It has the same bits on all machines with IEEE rounding.
inline float exp_minus(float x) {
  const float t = x * -1.44269504f;
  const float shifted = t + 12582912.0f;  // 1.5 * 2^23 rounds t to the nearest integer
  const float rounded = shifted - 12582912.0f;
  // ln 2 in two parts, the first with few enough digits for an exact product. t is not used, as it has lost digits
  // where x is large.
  const float r = (-x - rounded * 0.693359375f) + rounded * 2.12194440e-4f;
  float p = 1.0f / 720;
  p = p * r + 1.0f / 120;
  p = p * r + 1.0f / 24;
  p = p * r + 1.0f / 6;
  p = p * r + 0.5f;
  p = p * r + 1.0f;
  p = p * r + 1.0f;
  std::int32_t bits;
  std::memcpy(&bits, &p, sizeof bits);
  bits += static_cast<std::int32_t>(rounded) * (1 << 23);
  std::memcpy(&p, &bits, sizeof p);
  return p;
}

}  // namespace polyrecon
