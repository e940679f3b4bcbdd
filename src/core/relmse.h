#pragma once

namespace polyrecon {

/// Added to the squared radiance that relMSE divides by, radiance squared: keeps errors in the dark finite.
inline constexpr double relmse_floor = 0.01;

/// Denominator of a relative squared error at the given radiance: radiance^2 + relmse_floor. T is double or Real.
template <typename T>
T relmse_denominator(T radiance) {
  return radiance * radiance + static_cast<T>(relmse_floor);
}

/// Relative squared error of one sample: (x - r)^2 / (r^2 + relmse_floor).
template <typename T>
T relative_squared_error(T x, T reference) {
  return (x - reference) * (x - reference) / relmse_denominator(reference);
}

}  // namespace polyrecon
