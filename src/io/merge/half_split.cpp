#include "io/merge/half_split.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace polyrecon {
namespace {

constexpr double tolerated_unevenness = 1.25;

/// Samples of the larger half over those of the smaller one.
double unevenness(const std::vector<double>& samples, const std::vector<bool>& half_b) {
  std::array<double, 2> sums{};
  for (std::size_t k = 0; k < samples.size(); ++k) sums[half_b[k] ? 1 : 0] += samples[k];
  return std::max(sums[0], sums[1]) / std::min(sums[0], sums[1]);
}

}  // namespace

std::vector<bool> split_renders(const std::vector<double>& samples) {
  std::vector<bool> alternating(samples.size()), half_b(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) alternating[k] = k % 2 == 1;
  const double before = unevenness(samples, alternating);
  if (!(before > tolerated_unevenness)) return alternating;
  std::vector<std::size_t> longest_first(samples.size());
  std::iota(longest_first.begin(), longest_first.end(), std::size_t{0});
  std::stable_sort(longest_first.begin(), longest_first.end(),
                   [&](std::size_t i, std::size_t k) { return samples[i] > samples[k]; });
  double balance = 0;  // samples of A minus those of B
  for (const std::size_t k : longest_first) {
    half_b[k] = balance > 0;
    balance += half_b[k] ? -samples[k] : samples[k];
  }
  return unevenness(samples, half_b) < before ? half_b : alternating;
}

}  // namespace polyrecon
