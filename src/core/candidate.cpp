#include "core/candidate.h"

#include "core/color_layout.h"

namespace polyrecon {
namespace {

constexpr int bias_channels = ColorLayout::primaries, variance_channels = ColorLayout::primaries, order_channels = 1;

}  // namespace

Candidate make_candidate(int width, int height, int color_channels) {
  const auto image = [&](int channels) { return Image(width, height, channels); };
  return {{image(color_channels), image(color_channels)},
          image(bias_channels),
          image(variance_channels),
          image(order_channels)};
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
  return 2 * color_channels + bias_channels + variance_channels + order_channels;
}

}  // namespace polyrecon
