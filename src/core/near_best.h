#pragma once

namespace polyrecon {

/// How much something counts whose error (or risk) is `above` >= 0 that of the best: 1 at the best, falling linearly to
/// 0 at `tolerance` above it. So a choice between things that are as good as equal is a mean of them, which rounding
/// moves no further than the data. tolerance 0: the best alone counts.
inline double share_near_best(double above, double tolerance) {
  if (above < tolerance) return 1 - above / tolerance;
  return above > 0 ? 0 : 1;
}

}  // namespace polyrecon
