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

/// The part b of a neighbour in xi'(x) = (xi(x) + b (xi(x - 1) + xi(x + 1))) / sqrt(1 + 2 b^2) that gives neighbours
/// the correlation 2 b / (1 + 2 b^2).
double part_of_neighbour(double correlation) {
  return correlation > 0 ? (1 - std::sqrt(1 - 2 * correlation * correlation)) / (2 * correlation) : 0;
}

/// A standard normal number a pixel, correlated along rows and along columns.
class Normals {
 public:
  Normals(std::uint64_t key, int width, double correlation)
      : key_(key), part_(part_of_neighbour(correlation)), pitch_(width + (part_ > 0 ? 2 : 0)) {}

  double at(int x, int y) const {
    if (part_ == 0) return white(x, y);
    return (along_row(x, y) + part_ * (along_row(x, y - 1) + along_row(x, y + 1))) / (1 + 2 * part_ * part_);
  }

 private:
  double white(int x, int y) const {
    return normal(hash(key_ ^ static_cast<std::uint64_t>(std::int64_t{y} * pitch_ + x)));
  }
  double along_row(int x, int y) const { return white(x, y) + part_ * (white(x - 1, y) + white(x + 1, y)); }

  std::uint64_t key_;
  double part_;
  int pitch_;  ///< Numbers of a row: one more at either end where neighbours take part.
};

}  // namespace

std::array<Image, 2> split_halves(const Image& mean, const Image& variance, std::uint64_t stream, double correlation) {
  std::array<Image, 2> halves{mean, mean};
  for_rows(mean.height(), [&](int y) {
    for (int c = 0; c < mean.channels(); ++c) {
      const Normals xi(hash(stream * 64 + static_cast<std::uint64_t>(c)), mean.width(), correlation);
      for (int x = 0; x < mean.width(); ++x) {
        const double v = static_cast<double>(variance.at(x, y, c));
        if (!(v > 0)) continue;
        const auto offset = static_cast<Real>(std::sqrt(v) * xi.at(x, y));
        halves[0].at(x, y, c) += offset;
        halves[1].at(x, y, c) -= offset;
      }
    }
  });
  return halves;
}

}  // namespace polyrecon
