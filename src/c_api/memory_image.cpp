#include "c_api/memory_image.h"

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "core/parallel.h"
#include "io/values/beyond_range.h"
#include "polyrecon/error.h"
#include "polyrecon/file_info.h"

namespace polyrecon {
namespace {

constexpr int most_channels = 64;

std::ptrdiff_t bytes_of(polyrecon_format format) {
  return static_cast<std::ptrdiff_t>(format == POLYRECON_HALF ? sizeof(half) : sizeof(float));
}

/// The image with strides where it has none.
MemoryImage with_strides(MemoryImage image) {
  if (image.channel_stride != 0 || image.pixel_stride != 0 || image.row_stride != 0) return image;
  image.channel_stride = bytes_of(image.format);
  image.pixel_stride = image.channel_stride * image.channels;
  image.row_stride = image.pixel_stride * image.width;
  return image;
}

/// Calls visit(place of the sample in memory, place in the plane c, c) for every sample, rows in parallel. Samples need
/// not be aligned.
template <typename Visit>
void for_samples(const MemoryImage& packed, const Visit& visit) {
  const MemoryImage image = with_strides(packed);
  for_rows(image.height, [&](int y) {
    for (int c = 0; c < image.channels; ++c) {
      auto* place = static_cast<std::byte*>(image.data) + y * image.row_stride + c * image.channel_stride;
      const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width);
      for (int x = 0; x < image.width; ++x, place += image.pixel_stride)
        visit(place, row + static_cast<std::size_t>(x), c);
    }
  });
}

}  // namespace

void check(const std::string& name, const MemoryImage& image) {
  const auto require = [&](bool holds, const std::string& problem) {
    if (!holds) throw Error(ExitCode::Usage, fmt::format("image '{}': {}", name, problem));
  };
  require(image.data != nullptr, "has no data");
  require(image.format == POLYRECON_FLOAT || image.format == POLYRECON_HALF, "the format is neither float nor half");
  require(image.width > 0 && image.height > 0 && image.channels > 0,
          fmt::format("has {} x {} pixels of {} channels", image.width, image.height, image.channels));
  require(image.channels <= most_channels,
          fmt::format("has {} channels, at most {} are read", image.channels, most_channels));
  const std::size_t most = ReadLimits{}.max_pixels;
  require(static_cast<std::size_t>(image.width) <= most / static_cast<std::size_t>(image.height),
          fmt::format("has {} x {} pixels, more than the limit of {}", image.width, image.height, most));
  const MemoryImage set = with_strides(image);
  require((set.width == 1 || set.pixel_stride != 0) && (set.height == 1 || set.row_stride != 0) &&
              (set.channels == 1 || set.channel_stride != 0),
          "some strides are 0 and others are not; set all of them, or none");
}

std::string size_conflict(const std::string& name, const Image& image, const MemoryImage& other) {
  return fmt::format("image '{}': has {} x {} pixels of {} channels, {} x {} of {} are needed", name, other.width,
                     other.height, other.channels, image.width(), image.height(), image.channels());
}

Image read_memory(const MemoryImage& from) {
  Image image(from.width, from.height, from.channels);
  for_samples(from, [&](const std::byte* place, std::size_t i, int c) {
    if (from.format == POLYRECON_HALF) {
      half value;
      std::memcpy(&value, place, sizeof value);
      image.plane(c)[i] = static_cast<Real>(static_cast<float>(value));
    } else {
      float value = 0;
      std::memcpy(&value, place, sizeof value);
      image.plane(c)[i] = static_cast<Real>(value);
    }
  });
  return image;
}

void write_memory(const Image& image, const MemoryImage& to) {
  for_samples(to, [&](std::byte* place, std::size_t i, int c) {
    const auto value = static_cast<float>(image.plane(c)[i]);
    if (to.format == POLYRECON_HALF) {
      const half sample(std::isfinite(value) ? std::clamp(value, -largest_half, largest_half) : value);
      std::memcpy(place, &sample, sizeof sample);
    } else {
      std::memcpy(place, &value, sizeof value);
    }
  });
}

}  // namespace polyrecon
