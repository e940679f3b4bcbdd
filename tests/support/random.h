#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace polyrecon::test {

/// Random numbers that are the same with every standard library, unlike those of the distributions in <random>.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal, by the method of Box and Muller.
  double normal() {
    const double u = uniform() + 0x1p-54;
    return std::sqrt(-2 * std::log(u)) * std::cos(6.28318530717958648 * uniform());
  }
  /// 0 .. n - 1
  int below(int n) { return static_cast<int>(uniform() * n); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace polyrecon::test
