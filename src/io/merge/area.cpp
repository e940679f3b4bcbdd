#include "io/merge/area.h"

#include <algorithm>
#include <cstring>

#include "io/files/channel_reader.h"

namespace polyrecon {

void copy_common(const char* from, const Rect& source, char* to, const Rect& target, const Rect& within,
                 std::size_t size) {
  const Rect common = intersect(intersect(source, target), within);
  if (common.empty()) return;
  const auto offset = [&](const Rect& r, int y) {
    return (static_cast<std::size_t>(y - r.y0) * static_cast<std::size_t>(r.width()) +
            static_cast<std::size_t>(common.x0 - r.x0)) *
           size;
  };
  for (int y = common.y0; y < common.y1; ++y)
    std::memcpy(to + offset(target, y), from + offset(source, y), static_cast<std::size_t>(common.width()) * size);
}

std::vector<float> read_area(const FileInfo& file, int part, const std::vector<std::string>& channels,
                             const Rect& area) {
  const Rect& window = file.parts[static_cast<std::size_t>(part)].data_window;
  ChannelReader reader(file, part, channels);
  if (intersect(window, area) == area && window.width() == area.width()) return reader.read(area.y0, area.y1);
  std::vector<float> samples(area.area() * channels.size(), 0.0F);
  const Rect rows{window.x0, std::max(window.y0, area.y0), window.x1, std::min(window.y1, area.y1)};
  if (rows.empty()) return samples;
  const std::vector<float>& found = reader.read(rows.y0, rows.y1);
  for (std::size_t c = 0; c < channels.size(); ++c)
    copy_common(reinterpret_cast<const char*>(found.data() + c * rows.area()), rows,
                reinterpret_cast<char*>(samples.data() + c * area.area()), area, area, sizeof(float));
  return samples;
}

Rect area_of(const NativeBand& band) { return {band.x0, band.y0, band.x0 + band.width, band.y1}; }

void put(NativeChannel& channel, std::size_t i, double value) {
  const auto store = [&](auto sample) {
    std::memcpy(channel.samples.data() + i * sizeof sample, &sample, sizeof sample);
  };
  const auto narrow = static_cast<float>(value);
  channel.type == Imf::HALF ? store(half(narrow)) : store(narrow);
}

}  // namespace polyrecon
