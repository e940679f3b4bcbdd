#include "core/candidate.h"

namespace polyrecon {

Candidate make_candidate(int width, int height, int color_channels) {
  const auto image = [&](int channels) { return Image(width, height, channels); };
  return {{image(color_channels), image(color_channels)}, image(3), image(3), image(1)};
}

Candidate crop(const Candidate& candidate, const Rect& r) {
  return {{crop(candidate.half[0], r), crop(candidate.half[1], r)},
          crop(candidate.squared_bias, r),
          crop(candidate.variance, r),
          crop(candidate.order, r)};
}

void paste(const Candidate& source, const Rect& from, Candidate& target, int x, int y) {
  for (std::size_t h = 0; h < 2; ++h) paste(source.half[h], from, target.half[h], x, y);
  paste(source.squared_bias, from, target.squared_bias, x, y);
  paste(source.variance, from, target.variance, x, y);
  paste(source.order, from, target.order, x, y);
}

std::size_t candidate_channels(std::size_t color_channels) {
  constexpr std::size_t squared_bias = 3, variance = 3, order = 1;
  return 2 * color_channels + squared_bias + variance + order;
}

}  // namespace polyrecon
