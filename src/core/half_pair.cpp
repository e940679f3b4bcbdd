#include "core/half_pair.h"

namespace polyrecon {

HalfPair crop(const HalfPair& pair, const Rect& r) {
  return {{crop(pair.color[0], r), crop(pair.color[1], r)},
          crop(pair.variance, r),
          {crop(pair.features[0], r), crop(pair.features[1], r)},
          pair.epsilon,
          crop(pair.sampled, r),
          crop(pair.bound, r)};
}

std::size_t half_pair_channels(std::size_t color_channels, std::size_t feature_channels) {
  constexpr std::size_t variance = 3, mask = 1, bound = 1;
  return 2 * color_channels + variance + mask + bound + 2 * feature_channels;
}

}  // namespace polyrecon
