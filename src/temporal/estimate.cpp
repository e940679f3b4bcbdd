#include "temporal/estimate.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/mask.h"
#include "core/parallel.h"
#include "temporal/neighbour.h"

namespace polyrecon {
namespace {

/// Whether a pixel is seen in the neighbour and is a sample there.
unsigned char sees_sample(const Places& places, int x, int y) {
  const Image& mask = places.frame->pair.sampled;
  const unsigned char seen = places.seen[places.position.index(x, y)];
  if (!seen || mask.empty()) return seen;
  const auto nearest = [](Real position, int size) {
    return std::clamp(static_cast<int>(std::lround(position)), 0, size - 1);
  };
  return in_mask(mask, mask.index(nearest(places.position.at(x, y, 0), mask.width()),
                                  nearest(places.position.at(x, y, 1), mask.height())));
}

Estimate estimate_from(const Places& places, const Rect& area) {
  const HalfPair& pair = places.frame->pair;
  Estimate out{{sample_at(pair.color[0], places, area, true), sample_at(pair.color[1], places, area, true)},
               sample_at(pair.variance, places, area, false),
               {},
               {}};
  for (std::size_t s = 0; s < surfaces; ++s)
    if (const Image& image = places.frame->geometry.surface[s]; !image.empty())
      out.surface[s] = sample_at(image, places, area, true);
  for (int y = area.y0; y < area.y1; ++y)
    for (int x = area.x0; x < area.x1; ++x) out.valid.push_back(sees_sample(places, x, y));
  return out;
}

/// The mean of two estimates where both are valid, else the valid one. Surfaces that only one of them has are dropped.
Estimate combine(Estimate a, const Estimate& b) {
  for (std::size_t s = 0; s < surfaces; ++s)
    if (b.surface[s].empty()) a.surface[s] = {};
  for_rows(a.variance.height(), [&](int y) {
    for (int x = 0; x < a.variance.width(); ++x) {
      const std::size_t i = a.variance.index(x, y);
      if (!b.valid[i]) continue;
      const bool both = a.valid[i] != 0;
      const auto average = [&](Image& of, const Image& with) {
        for (int c = 0; c < of.channels(); ++c)
          of.plane(c)[i] = both ? Real(0.5) * (of.plane(c)[i] + with.plane(c)[i]) : with.plane(c)[i];
      };
      for (std::size_t h = 0; h < 2; ++h) average(a.color[h], b.color[h]);
      for (std::size_t s = 0; s < surfaces; ++s) average(a.surface[s], b.surface[s]);
      average(a.variance, b.variance);
      if (both)  // the variance of a mean of two
        for (int c = 0; c < 3; ++c) a.variance.plane(c)[i] *= Real(0.5);
      a.valid[i] = 1;
    }
  });
  return a;
}

}  // namespace

Estimate estimate_at(const std::vector<Places>& all, int k, const Rect& area) {
  Estimate out;
  for (const Places& places : all)
    if (std::abs(places.offset) == k)
      out = out.valid.empty() ? estimate_from(places, area) : combine(std::move(out), estimate_from(places, area));
  return out;
}

}  // namespace polyrecon
