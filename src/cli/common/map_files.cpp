#include "cli/common/map_files.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/rect.h"
#include "io/files/file.h"
#include "io/values/pass_values.h"
#include "maps/error_map_images.h"
#include "polyrecon/error.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

Image plane_of(const Image& image, int channel) {
  Image out(image.width(), image.height(), 1);
  std::copy(image.plane(channel), image.plane(channel) + image.pixels(), out.plane(0));
  return out;
}

bool has_channel(const PartInfo& part, const std::string& name) {
  return std::any_of(part.channels.begin(), part.channels.end(), [&](const ChannelInfo& c) { return c.name == name; });
}

/// The image on the whole display window, zero where it has no pixels.
Image on_display(const Image& image, const MapWindows& windows) {
  if (windows.display.area() > ReadLimits{}.max_pixels)
    throw Error(ExitCode::BadInput, "the display window is too large for a sample map in a renderer's format");
  Image out(windows.display.width(), windows.display.height(), image.channels());
  const Rect seen = intersect(windows.data, windows.display);
  if (seen.empty()) return out;
  const Rect from{seen.x0 - windows.data.x0, seen.y0 - windows.data.y0, seen.x1 - windows.data.x0,
                  seen.y1 - windows.data.y0};
  paste(image, from, out, seen.x0 - windows.display.x0, seen.y0 - windows.display.y0);
  return out;
}

Image values_for(SampleMapFormat::Values values, const SampleMap& map) {
  if (values == SampleMapFormat::Values::Importance) return map.importance;
  Image mask = map.samples;
  for (std::size_t i = 0; i < mask.pixels(); ++i) mask.plane(0)[i] = mask.plane(0)[i] >= Real{0.5} ? 1 : 0;
  return mask;
}

std::vector<MapChannel> channels_for(const SampleMapFormat* format, const SampleMap& map, const MapWindows& windows) {
  if (!format) return {{"samples.Y", map.samples}, {"importance.Y", map.importance}};
  const Image values = on_display(values_for(format->values, map), windows);
  std::vector<MapChannel> channels;
  for (const std::string& name : format->channels) channels.push_back({name, values});
  return channels;
}

}  // namespace

void write_error_map(const std::string& target, const ErrorMap& map, const Image& sample_count,
                     const MapWindows& windows) {
  std::vector<MapChannel> channels;
  for (const ErrorMapImage& entry : error_map_images) {
    if ((map.*entry.image).empty()) continue;
    for (std::size_t c = 0; c < entry.channels(); ++c)
      channels.push_back({entry.names[c], plane_of(map.*entry.image, static_cast<int>(c))});
  }
  if (!sample_count.empty()) channels.push_back({"samples.Y", sample_count});
  write_maps(target, channels, windows.data, windows.display);
}

ErrorMapFile read_error_map(const std::string& path) {
  const FileInfo file = describe_file(path);
  const PartInfo& part = file.parts.front();
  ErrorMapFile result;
  for (const ErrorMapImage& entry : error_map_images) {
    const std::vector<std::string> names(entry.names.begin(),
                                         entry.names.begin() + static_cast<std::ptrdiff_t>(entry.channels()));
    const auto missing =
        std::find_if(names.begin(), names.end(), [&](const std::string& name) { return !has_channel(part, name); });
    if (missing == names.end())
      result.map.*entry.image = read_channels(file, 0, names);
    else if (!entry.may_be_missing)
      throw Error(ExitCode::Missing,
                  path + ": no channel " + *missing + "; name a file that denoise --error-map wrote");
  }
  if (has_channel(part, "samples.Y")) result.sample_count = read_channels(file, 0, {"samples.Y"});
  if (repair_counts(result.sample_count) == result.sample_count.pixels()) result.sample_count = {};
  result.windows = {part.data_window, part.display_window};
  return result;
}

void write_order_map(const std::string& target, const Image& order, const MapWindows& windows) {
  write_maps(target, {{"order.Y", order}}, windows.data, windows.display);
}

void write_sample_map(const std::string& target, const SampleMap& map, const MapWindows& windows,
                      const SampleMapOrigin& origin, const SampleMapFormat* format) {
  MapAttributes attributes;
  attributes.numbers = {{"min", map.min},
                        {"max", map.max},
                        {"total", map.total},
                        {"budget", origin.budget},
                        {"target", origin.target},
                        {"frame", origin.frame},
                        {"seed", origin.seed},
                        {"errorBefore", map.error_before},
                        {"errorAfter", map.error_after}};
  const Rect& display = windows.display;
  const Rect canvas{0, 0, display.width(), display.height()};
  write_maps(target, channels_for(format, map, windows), format ? canvas : windows.data, format ? canvas : display,
             attributes);
}

}  // namespace polyrecon
