#pragma once

#include <string>
#include <vector>

#include "io/channel_names.h"
#include "io/exr/file.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// An image file with its layers, for the commands that look at single layers instead of a frame.
struct LayeredFile {
  FileInfo info;
  std::vector<Layer> layers;
};

/// Throws as describe_file does.
LayeredFile open_layers(const std::string& path);

/// The layer by its whole name, or nullptr.
const Layer* find_layer(const LayeredFile& file, const std::string& name);

/// The colour layer that a comparison is about: R, G, B and a name (without view layer) of Combined, Color, Beauty,
/// RGB, Denoised or none, the first by name; nullptr where there is none.
const Layer* color_layer(const LayeredFile& file);

/// The samples of all channels of the layer.
Image read_layer(const LayeredFile& file, const Layer& layer);

/// The cost of a sample per pixel (1 channel): the layer `Render Time`, or the only channel of the file.
/// Throws Error{Missing} where there is neither.
Image read_cost(const std::string& path);

}  // namespace polyrecon
