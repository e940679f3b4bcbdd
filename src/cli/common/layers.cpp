#include "cli/common/layers.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "io/channel_names.h"
#include "io/exr/file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// "ViewLayer.Combined.R" -> "ViewLayer.Combined"; "R" -> "".
std::string without_last(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string::npos ? std::string() : channel.substr(0, dot);
}

std::string last_of(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? name : name.substr(dot + 1);
}

bool is_rgb(const Layer& layer) {
  constexpr std::array<const char*, 3> suffixes{"R", "G", "B"};
  if (layer.channels.size() != suffixes.size()) return false;
  for (std::size_t c = 0; c < suffixes.size(); ++c)
    if (last_of(layer.channels[c]) != suffixes[c]) return false;
  return true;
}

}  // namespace

LayeredFile open_layers(const std::string& path) {
  LayeredFile file;
  file.info = describe_file(path);
  file.layers = find_layers(file.info);
  return file;
}

const Layer* find_layer(const LayeredFile& file, const std::string& name) {
  for (const Layer& layer : file.layers)
    if (layer.name == name || (!layer.channels.empty() && without_last(layer.channels[0]) == name)) return &layer;
  return nullptr;
}

const Layer* color_layer(const LayeredFile& file) {
  static const std::array<std::string, 6> names{"", "beauty", "color", "combined", "denoised", "rgb"};
  const Layer* best = nullptr;
  for (const Layer& layer : file.layers) {
    if (!is_rgb(layer)) continue;
    const std::string name = without_last(layer.channels[0]);
    if (!std::binary_search(names.begin(), names.end(), lower(last_of(name)))) continue;
    if (!best || name < without_last(best->channels[0])) best = &layer;
  }
  return best;
}

Image read_layer(const LayeredFile& file, const Layer& layer) {
  return read_channels(file.info, layer.part, layer.channels);
}

Image read_cost(const std::string& path) {
  const LayeredFile file = open_layers(path);
  for (const Layer& layer : file.layers)
    if (last_of(layer.name) == "Render Time" && layer.channels.size() == 1) return read_layer(file, layer);
  if (file.layers.size() == 1 && file.layers[0].channels.size() == 1) return read_layer(file, file.layers[0]);
  throw Error(ExitCode::Missing, path + ": no layer Render Time and not a single channel: no cost per pixel");
}

}  // namespace polyrecon
