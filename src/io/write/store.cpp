#include "io/write/store.h"

#include <half.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/values/beyond_range.h"

namespace polyrecon {

void store(NativeChannel& channel, std::size_t i, float value, std::size_t& saturated) {
  if (channel.type == Imf::HALF) {
    if (std::abs(value) > largest_half) {
      value = std::copysign(largest_half, value);
      ++saturated;
    }
    const half h(value);
    std::memcpy(channel.samples.data() + i * sizeof h, &h, sizeof h);
  } else if (channel.type == Imf::FLOAT) {
    std::memcpy(channel.samples.data() + i * sizeof value, &value, sizeof value);
  } else {
    const double whole = std::isfinite(value) ? std::round(std::max(value, 0.0f)) : 0;
    const auto u = static_cast<unsigned int>(std::min<double>(whole, std::numeric_limits<unsigned int>::max()));
    std::memcpy(channel.samples.data() + i * sizeof u, &u, sizeof u);
  }
}

}  // namespace polyrecon
