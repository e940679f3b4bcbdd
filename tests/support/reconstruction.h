#pragma once

#include <cmath>

#include "polyrecon/reconstruct.h"
#include "support/images.h"

namespace polyrecon::test {

/// Parameters for quick tests: two stages and two levels with small windows, so that every part of the method runs.
inline Params quick() {
  Params params;
  params.stages = 2;
  params.levels = 2;
  params.radius = 5;
  params.stride = 2;
  return params;
}

inline Result run(const Frame& frame, const Params& params = quick()) {
  Frame taken = frame;
  return reconstruct(taken, params, silent_progress());
}

inline bool finite(const Result& result) {
  bool all = all_finite(result.beauty) && all_finite(result.order) && all_finite(result.error.mse) &&
             all_finite(result.error.relative_mse) && all_finite(result.error.relative_variance) &&
             all_finite(result.error.relative_noise) && std::isfinite(result.error.mean_relative_mse);
  for (const Image& aov : result.aovs) all &= all_finite(aov);
  return all;
}

}  // namespace polyrecon::test
