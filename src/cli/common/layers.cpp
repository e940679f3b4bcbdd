#include "cli/common/layers.h"

#include <fmt/format.h>

#include <utility>

#include "io/files/file.h"
#include "io/layers/channel_names.h"
#include "io/renderers/known_names.h"
#include "io/values/pass_values.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// "ViewLayer.Combined.R" -> "ViewLayer.Combined"; "R" -> "".
std::string without_last(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string::npos ? std::string() : channel.substr(0, dot);
}

/// The layer with the variance, preferably that of the mean; nullptr without one.
const Layer* variance_layer(const LayeredFile& file, const Layer& layer) {
  const Layer* first = nullptr;
  for (const Layer& other : file.layers) {
    if (!is_variance(other.companion) || other.of != layer.name) continue;
    if (other.companion == Companion::VarianceOfMean) return &other;
    if (!first) first = &other;
  }
  return first;
}

const Layer* sample_count_layer(const LayeredFile& file, const Layer& of) {
  const Layer* best = nullptr;
  for (const Layer& layer : file.layers)
    if (layer.role == Role::SampleCount && layer.view_layer == of.view_layer && layer.view == of.view &&
        (!best || layer.rank < best->rank))
      best = &layer;
  return best;
}

/// The layer that says what a sample costs.
const Layer& cost_layer(const LayeredFile& file) {
  for (const Layer& layer : file.layers)
    if (is_render_time(layer.pass) && layer.channels.size() == 1) return layer;
  if (file.layers.size() == 1 && file.layers[0].channels.size() == 1) return file.layers[0];
  throw Error(ExitCode::Missing, file.info.path + ": no render-time pass and more than one channel: no cost per pixel");
}

std::string unused(const LayeredFile& file, const Layer& layer, const std::string& why) {
  return fmt::format("{}: {} is not used: {}", file.info.path, layer.name, why);
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

bool is_color(const Layer& layer) {
  return (layer.channels.size() == 3 || layer.channels.size() == 1) && layer.companion == Companion::Mean &&
         info_of(layer.role).values == Values::Radiance;
}

bool is_error_map(const LayeredFile& file) { return find_layer(file, "relmse") != nullptr; }

const Layer* color_layer(const LayeredFile& file) {
  if (is_error_map(file)) return nullptr;
  const Layer* picture = picture_layer(file.layers);
  return picture && is_color(*picture) ? picture : nullptr;
}

const Layer& require_color_layer(const LayeredFile& file) {
  if (const Layer* layer = color_layer(file)) return *layer;
  throw Error(ExitCode::Missing, file.info.path +
                                     ": no colour layer that has a name of a renderer's beauty; `polyrecon inspect` "
                                     "lists the layers");
}

const Layer& main_layer(const LayeredFile& file) {
  if (const Layer* color = color_layer(file)) return *color;
  for (const char* name : {"relmse", "samples", "order"})
    if (const Layer* map = find_layer(file, name)) return *map;
  if (file.layers.empty()) throw Error(ExitCode::Missing, file.info.path + ": has no layer to show");
  return file.layers.front();
}

Image read_layer(const LayeredFile& file, const Layer& layer) {
  return read_channels(file.info, layer.part, layer.channels);
}

Image read_radiance(const LayeredFile& file, const Layer& layer) {
  Image image = with_channels(read_layer(file, layer), 3);
  if (is_picture_in_xyz(layer)) xyz_to_rgb_values(image);
  return image;
}

KnownVariance read_variance(const LayeredFile& file, const Layer& layer, const Image& mean) {
  const Layer* found = variance_layer(file, layer);
  if (!found) return {};
  Image values = with_channels(read_layer(file, *found), mean.channels());
  if (!values.same_shape(mean)) return {{}, unused(file, *found, "its data window is not the layer's")};
  Image counted;
  SampleCounts counts{nullptr, samples_in_metadata(file.info, layer.view_layer).value_or(0)};
  if (const Layer* samples = sample_count_layer(file, layer)) {
    counted = read_layer(file, *samples);
    if (counted.pixels() == mean.pixels() && to_sample_counts(counted, samples->pass, counts.everywhere))
      counts.per_pixel = &counted;
  }
  if (found->companion != Companion::VarianceOfMean && !counts.known())
    return {{},
            unused(file, *found,
                   fmt::format("it is the {} and the file does not say how many samples a pixel has; the noise of "
                               "{} counts as error",
                               name_of(found->companion), layer.name))};
  const bool in_xyz = is_picture_in_xyz(layer) && values.channels() == 3;
  const bool is_moment = found->companion == Companion::SecondMoment;
  to_variance_of_mean(values, in_xyz && is_moment ? Companion::SecondMomentOfXyz : found->companion, mean, counts);
  if (in_xyz && !is_moment) xyz_to_rgb_variances(values);
  return {std::move(values), {}};
}

void require_cost(const std::string& path, int width, int height) {
  const LayeredFile file = open_layers(path);
  const Rect window = file.info.parts[static_cast<std::size_t>(cost_layer(file).part)].data_window;
  if (window.width() != width || window.height() != height)
    throw Error(ExitCode::BadInput, fmt::format("{}: has {} x {} pixels, the frame has {} x {}", path, window.width(),
                                                window.height(), width, height));
}

Image read_cost(const std::string& path) {
  const LayeredFile file = open_layers(path);
  return read_layer(file, cost_layer(file));
}

}  // namespace polyrecon
