#pragma once

#include <vector>

namespace polyrecon {

/// A pixel o whose value was replaced.
struct Outlier {
  int x = 0, y = 0;
  /// e_o of equation (11): what the replacement took from the mean of the halves, radiance x pixels, for each channel
  /// of the beauty and the AOVs.
  std::vector<double> energy;
};

}  // namespace polyrecon
