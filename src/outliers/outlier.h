#pragma once

#include <vector>

namespace polyrecon {

/// A pixel o whose value was replaced, and the energy e_o of equation (11) that was taken from the mean of the halves:
/// one value per colour channel (beauty, then each AOV), radiance x pixels.
struct Outlier {
  int x = 0, y = 0;
  std::vector<double> energy;
};

}  // namespace polyrecon
