#include "blend/levels.h"

#include <array>
#include <utility>
#include <vector>

#include "blend/select.h"
#include "core/mask.h"
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
    out.color[h] = half_resolution(pair.color[h], pair.sampled);
    out.features[h] = half_resolution(pair.features[h], pair.sampled);
  }
  out.variance = half_resolution(pair.variance, pair.sampled);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.variance.pixels(); ++i) out.variance.plane(c)[i] *= Real(0.25);
  if (!pair.sampled.empty()) {
    const Image share = half_resolution(pair.sampled);  // of the four pixels
    out.variance = divided_by_share(std::move(out.variance), share);
    out.sampled = share;
    for (std::size_t i = 0; i < share.pixels(); ++i)
      out.sampled.plane(0)[i] = share.plane(0)[i] > 0 ? Real(1) : Real(0);
  }
  out.epsilon = pair.epsilon;
  return out;
}

Candidate add_coarse(const HalfPair& pair, Candidate fine, const Candidate& coarse, const SelectParams& params,
                     std::size_t max_bytes) {
  const Image coarse_mask = pair.sampled.empty() ? Image() : half_resolution(pair.sampled);  // > 0: partly inside
  std::array<Image, 2> remainder;
  for (std::size_t h = 0; h < 2; ++h)
    remainder[h] = double_resolution(plus(coarse.half[h], -1, half_resolution(fine.half[h], pair.sampled)),
                                     pair.width(), pair.height(), coarse_mask);
  const auto make = [&](const std::array<Image, 2>& halves, const Rect& region) {
    std::vector<std::array<Image, 2>> corrected(2);
    for (std::size_t h = 0; h < 2; ++h) {
      const Image u = crop(remainder[h], region);
      corrected[0][h] = plus(halves[h], Real(0.5), u);
      corrected[1][h] = plus(halves[h], 1, u);
    }
    return corrected;
  };
  fine.half = select_correction(pair, fine.half, {2, 0, make}, params, max_bytes);
  return fine;
}

}  // namespace polyrecon
