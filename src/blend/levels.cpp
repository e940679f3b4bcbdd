#include "blend/levels.h"

#include <utility>

#include "core/resample.h"

namespace polyrecon {
namespace {

/// a + factor * b
Image plus(Image a, Real factor, const Image& b) {
  for (int c = 0; c < a.channels(); ++c) {
    Real* p = a.plane(c);
    const Real* q = b.plane(c);
    for (std::size_t i = 0; i < a.pixels(); ++i) p[i] += factor * q[i];
  }
  return a;
}

}  // namespace

HalfPair downsample(const HalfPair& pair) {
  HalfPair out;
  for (std::size_t h = 0; h < 2; ++h) {
    out.color[h] = half_resolution(pair.color[h]);
    out.features[h] = half_resolution(pair.features[h]);
  }
  out.variance = half_resolution(pair.variance);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.variance.pixels(); ++i) out.variance.plane(c)[i] *= Real(0.25);
  out.epsilon = pair.epsilon;
  return out;
}

Candidate add_coarse(const HalfPair& pair, Candidate fine, const Candidate& coarse, const SelectParams& params) {
  std::vector<Candidate> corrected(2);
  for (std::size_t h = 0; h < 2; ++h) {
    const Image remainder =
        double_resolution(plus(coarse.half[h], -1, half_resolution(fine.half[h])), pair.width(), pair.height());
    corrected[0].half[h] = plus(fine.half[h], Real(0.5), remainder);
    corrected[1].half[h] = plus(fine.half[h], 1, remainder);
  }
  return select_correction(pair, std::move(fine), std::move(corrected), params);
}

}  // namespace polyrecon
