#include "cli/common/layers.h"

#include "io/channel_names.h"
#include "io/exr/file.h"
#include "io/renderers/known_names.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// "ViewLayer.Combined.R" -> "ViewLayer.Combined"; "R" -> "".
std::string without_last(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string::npos ? std::string() : channel.substr(0, dot);
}

}  // namespace

LayeredFile open_layers(const std::string& path) {
  LayeredFile file;
  file.info = describe_file(path);
  file.layers = find_layers(file.info);
  if (!picture_layer(file.layers)) adopt_only_color(file.layers);
  return file;
}

const Layer* find_layer(const LayeredFile& file, const std::string& name) {
  for (const Layer& layer : file.layers)
    if (layer.name == name || (!layer.channels.empty() && without_last(layer.channels[0]) == name)) return &layer;
  return nullptr;
}

const Layer* color_layer(const LayeredFile& file) {
  const Layer* picture = picture_layer(file.layers);
  return picture && picture->channels.size() == 3 ? picture : nullptr;
}

const Layer& require_color_layer(const LayeredFile& file) {
  if (const Layer* layer = color_layer(file)) return *layer;
  throw Error(ExitCode::Missing, file.info.path +
                                     ": no colour layer that has a name of a renderer's beauty; `polyrecon inspect` "
                                     "lists the layers");
}

const Layer* variance_layer(const LayeredFile& file, const Layer& layer) {
  for (const Layer& other : file.layers)
    if (other.companion == Companion::VarianceOfMean && other.of == layer.name &&
        other.channels.size() == layer.channels.size())
      return &other;
  return nullptr;
}

Image read_layer(const LayeredFile& file, const Layer& layer) {
  return read_channels(file.info, layer.part, layer.channels);
}

Image read_cost(const std::string& path) {
  const LayeredFile file = open_layers(path);
  for (const Layer& layer : file.layers)
    if (is_render_time(layer.pass) && layer.channels.size() == 1) return read_layer(file, layer);
  if (file.layers.size() == 1 && file.layers[0].channels.size() == 1) return read_layer(file, file.layers[0]);
  throw Error(ExitCode::Missing, path + ": no render-time pass and more than one channel: no cost per pixel");
}

}  // namespace polyrecon
