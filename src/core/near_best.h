#pragma once

namespace polyrecon {

/// Share of a candidate whose error (or risk) is `above` >= 0 more than that of the best one: 1 at the best, falling
/// linearly to 0 at `tolerance`. So a choice among candidates that are about equally good becomes their mean, which
/// changes continuously with the data: rounding cannot change it much. With tolerance 0 only the best counts.
inline double share_near_best(double above, double tolerance) {
  if (above < tolerance) return 1 - above / tolerance;
  return above > 0 ? 0 : 1;
}

}  // namespace polyrecon
