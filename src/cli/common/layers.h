#pragma once

#include <string>
#include <vector>

#include "io/files/file.h"
#include "io/layers/channel_names.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// An image file and its layers, for commands that work on single layers rather than on a frame.
struct LayeredFile {
  FileInfo info;
  std::vector<Layer> layers;
};

/// Throws as describe_file does.
LayeredFile open_layers(const std::string& path);

/// The layer of this whole name, or nullptr.
const Layer* find_layer(const LayeredFile& file, const std::string& name);

/// Whether a layer holds radiance, in three channels or in one of grey.
bool is_color(const Layer& layer);

/// Whether a file is an error map, whose only colours are errors.
bool is_error_map(const LayeredFile& file);

/// The picture (io/layers/channel_names.h) if it is_color, else nullptr, as for an error map.
const Layer* color_layer(const LayeredFile& file);

/// The same; throws Error{Missing} where there is none.
const Layer& require_color_layer(const LayeredFile& file);

/// The layer to show unless one was named: the picture, else the main layer of a map, else the first layer. Throws
/// Error{Missing} for a file without layers.
const Layer& main_layer(const LayeredFile& file);

/// All channels of a layer.
Image read_layer(const LayeredFile& file, const Layer& layer);

/// A layer that is_color, as RGB: grey is repeated, a picture in CIE XYZ is converted.
Image read_radiance(const LayeredFile& file, const Layer& layer);

/// The variance of a layer's mean, if its file holds it.
struct KnownVariance {
  Image variance;    ///< Empty where it is unknown.
  std::string note;  ///< Why a layer with it is not used; empty otherwise.
};

/// The variance of the mean of a layer, whose values are `mean`, as read_radiance reads them.
KnownVariance read_variance(const LayeredFile& file, const Layer& layer, const Image& mean);

/// Checks the headers of a file of costs before any work. Throws where read_cost would, and Error{BadInput} where it
/// has another size than the frame.
void require_cost(const std::string& path, int width, int height);

/// The cost of a sample in each pixel, 1 channel: a render-time pass, or the only channel of the file.
/// Throws Error{Missing} where there is neither.
Image read_cost(const std::string& path);

}  // namespace polyrecon
