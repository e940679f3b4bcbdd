#include "core/half_pair.h"

namespace polyrecon {

HalfPair crop(const HalfPair& pair, const Rect& r) {
  return {{crop(pair.color[0], r), crop(pair.color[1], r)},
          crop(pair.variance, r),
          {crop(pair.features[0], r), crop(pair.features[1], r)},
          pair.epsilon};
}

}  // namespace polyrecon
