#include "io/values/beyond_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "io/layers/channel_names.h"
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

template <typename Sample>
std::size_t drop_lone_overflows(Sample* plane, int width, int height) {
  const auto overflows = [&](int x, int y) {
    return x >= 0 && x < width && y >= 0 && y < height &&
           plane[static_cast<std::ptrdiff_t>(y) * width + x] == std::numeric_limits<Sample>::infinity();
  };
  const auto neighbours = [&](int x, int y) {
    std::vector<std::pair<int, int>> found;
    for (int v = y - 1; v <= y + 1; ++v)
      for (int u = x - 1; u <= x + 1; ++u)
        if ((u != x || v != y) && overflows(u, v)) found.emplace_back(u, v);
    return found;
  };
  std::vector<std::ptrdiff_t> lone;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!overflows(x, y)) continue;
      const auto near = neighbours(x, y);
      if (near.empty() || (near.size() == 1 && neighbours(near[0].first, near[0].second).size() == 1))
        lone.push_back(static_cast<std::ptrdiff_t>(y) * width + x);
    }
  for (const std::ptrdiff_t place : lone) plane[place] = std::numeric_limits<Sample>::quiet_NaN();
  return lone.size();
}

template std::size_t drop_lone_overflows(float*, int, int);
template std::size_t drop_lone_overflows(double*, int, int);

std::size_t half_overflows(const PartInfo& part, const Layer& layer, const Image& image) {
  std::size_t count = 0;
  for (int c = 0; c < image.channels(); ++c)
    if (is_half_float(part, layer.channels[static_cast<std::size_t>(c)]))
      count += static_cast<std::size_t>(
          std::count(image.plane(c), image.plane(c) + image.pixels(), std::numeric_limits<Real>::infinity()));
  return count;
}

std::string lone_overflow_note(const std::string& layer, std::size_t samples) {
  return fmt::format(
      "{}: {} half-float samples of +Inf stand alone and are fireflies of unknown value; they count as missing; "
      "save as 32-bit float to keep them",
      layer, samples);
}

std::string overflow_note(const std::string& layer, std::size_t samples) {
  return fmt::format(
      "{}: {} half-float samples of +Inf count as {}, the largest half; save as 32-bit float to keep "
      "what is brighter",
      layer, samples, largest_half);
}

}  // namespace polyrecon
