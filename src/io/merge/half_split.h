#pragma once

#include <vector>

namespace polyrecon {

/// Divides renders into halves A and B of about the same number of samples. samples: mean of each render per pixel.
/// Returns for each render whether it is of half B. Renders alternate, A first. If that gives one half more than
/// 1.25 times the samples of the other, the renders are taken from the longest to the shortest, each into the half with
/// fewer samples so far, unless that is no more even.
std::vector<bool> split_renders(const std::vector<double>& samples);

}  // namespace polyrecon
