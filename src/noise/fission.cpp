#include "noise/fission.h"

#include <cmath>

#include "core/parallel.h"

namespace polyrecon {
namespace {

/// SplitMix64 (Steele, Lea and Flood 2014) used as a hash, so that any number of the stream is computed without the
/// ones before it.
std::uint64_t hash(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/// A standard normal number from two hashes, by the method of Box and Muller.
double normal(std::uint64_t key) {
  const double u = (static_cast<double>(hash(key) >> 11) + 0.5) * 0x1p-53;
  const double v = static_cast<double>(hash(key ^ 0xD1B54A32D192ED03u) >> 11) * 0x1p-53;
  return std::sqrt(-2 * std::log(u)) * std::cos(6.28318530717958648 * v);
}

}  // namespace

std::array<Image, 2> split_halves(const Image& mean, const Image& variance, std::uint64_t stream) {
  std::array<Image, 2> halves{mean, mean};
  for_rows(mean.height(), [&](int y) {
    for (int c = 0; c < mean.channels(); ++c)
      for (int x = 0; x < mean.width(); ++x) {
        const double v = static_cast<double>(variance.at(x, y, c));
        if (!(v > 0)) continue;
        const std::uint64_t key = hash(hash(stream * 64 + static_cast<std::uint64_t>(c)) ^ mean.index(x, y));
        const auto offset = static_cast<Real>(std::sqrt(v) * normal(key));
        halves[0].at(x, y, c) += offset;
        halves[1].at(x, y, c) -= offset;
      }
  });
  return halves;
}

}  // namespace polyrecon
