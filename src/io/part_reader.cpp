#include "io/part_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/rect.h"
#include "io/files/file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Copies what a band of a part has inside the frame's window to planes that cover this window.
void place_band(const Band& band, const Rect& part, const Rect& frame, const std::vector<Real*>& planes) {
  if (part == frame) return copy_band(band, planes);
  const auto width = static_cast<std::size_t>(part.width());
  const int y0 = part.y0 + static_cast<int>(band.first_pixel / width);
  const Rect common = intersect({part.x0, y0, part.x1, y0 + static_cast<int>(band.pixels / width)}, frame);
  if (common.empty()) return;
  const auto index = [](const Rect& window, int y, int x) {
    return static_cast<std::ptrdiff_t>(y - window.y0) * window.width() + (x - window.x0);
  };
  for (std::size_t c = 0; c < planes.size(); ++c)
    for (int y = common.y0; y < common.y1; ++y)
      std::copy_n(band.samples.begin() + static_cast<std::ptrdiff_t>(band.pixels * c) +
                      index({part.x0, y0, part.x1, part.y1}, y, common.x0),
                  common.width(), planes[c] + index(frame, y, common.x0));
}

void add_other_channels(const FileInfo& file, int part, std::vector<std::string>& channels) {
  const std::vector<std::string> used = channels;
  for (const ChannelInfo& channel : file.parts[static_cast<std::size_t>(part)].channels)
    if (std::find(used.begin(), used.end(), channel.name) == used.end()) channels.push_back(channel.name);
}

}  // namespace

Image* PartReader::want(const Layer& layer, const std::vector<std::string>& channels) {
  samples_ += window_.area() * channels.size();
  if (samples_ > limits_.max_bytes / sizeof(Real))
    throw Error(ExitCode::OutOfMemory, fmt::format("{}: the passes in use need more than the limit of {} MB",
                                                   source_.path, limits_.max_bytes >> 20));
  auto& wanted = parts_[{layer.file, layer.part}];
  wanted.push_back({channels, std::make_unique<Image>()});
  return wanted.back().image.get();
}

void PartReader::read(const BandObserver& observer) {
  for (auto& [place, wanted] : parts_) {
    const FileInfo& file = source_.files[static_cast<std::size_t>(place.first)];
    const Rect part = file.parts[static_cast<std::size_t>(place.second)].data_window;
    std::vector<std::string> channels;
    std::vector<Real*> planes;
    std::vector<std::pair<Real*, Real*>> repeated;
    for (Wanted& w : wanted) {
      *w.image = Image(window_.width(), window_.height(), static_cast<int>(w.channels.size()));
      for (std::size_t c = 0; c < w.channels.size(); ++c) {
        Real* plane = w.image->plane(static_cast<int>(c));
        const auto known = std::find(channels.begin(), channels.end(), w.channels[c]);
        if (known != channels.end()) {
          repeated.emplace_back(planes[static_cast<std::size_t>(known - channels.begin())], plane);
          continue;
        }
        channels.push_back(w.channels[c]);
        planes.push_back(plane);
      }
    }
    if (observer) add_other_channels(file, place.second, channels);
    read_bands(file, place.second, channels, [&, place = place](const Band& band) {
      place_band(band, part, window_, planes);
      if (observer) observer(source_, place.first, place.second, channels, band);
    });
    for (const auto& [from, to] : repeated) std::copy_n(from, window_.area(), to);
  }
}

}  // namespace polyrecon
