#include "io/beyond_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "io/channel_names.h"
#include "io/renderers/known_names.h"

namespace polyrecon {
namespace {

bool is_half_float(const PartInfo& part, const std::string& channel) {
  return std::any_of(part.channels.begin(), part.channels.end(),
                     [&](const ChannelInfo& c) { return c.name == channel && c.type == SampleType::Half; });
}

}  // namespace

BeyondRange beyond_range(const PartInfo& part, const Layer& layer, Role role, const std::string& channel) {
  if (layer.companion != Companion::Mean && !is_half(layer.companion)) return BeyondRange::AsStored;
  if (info_of(role).empty == EmptyValue::ZeroOrSky) return BeyondRange::Sky;
  const bool radiance = info_of(role).values == Values::Radiance && channel != layer.alpha;
  return radiance && is_half_float(part, channel) ? BeyondRange::LargestHalf : BeyondRange::AsStored;
}

template <typename Sample>
std::size_t bring_into_range(BeyondRange beyond, Sample* samples, std::size_t count) {
  std::size_t replaced = 0;
  if (beyond == BeyondRange::Sky) {
    const auto sky = static_cast<Sample>(sky_value());
    for (std::size_t i = 0; i < count; ++i)
      if (samples[i] > sky) samples[i] = sky;
  } else if (beyond == BeyondRange::LargestHalf) {
    for (std::size_t i = 0; i < count; ++i)
      if (samples[i] == std::numeric_limits<Sample>::infinity()) {
        samples[i] = largest_half;
        ++replaced;
      }
  }
  return replaced;
}

template std::size_t bring_into_range(BeyondRange, float*, std::size_t);
template std::size_t bring_into_range(BeyondRange, double*, std::size_t);

std::string overflow_note(const std::string& layer, std::size_t samples) {
  return fmt::format(
      "{}: {} half-float samples of +Inf count as {}, the largest half; save as 32-bit float to keep "
      "what is brighter",
      layer, samples, largest_half);
}

}  // namespace polyrecon
