#include "polyrecon/write_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/renderers/polyrecon.h"
#include "io/write/part_rewrite.h"
#include "io/write/rewrite.h"

namespace polyrecon {
namespace {

/// The channel of a replacement or an addition as one of a map; type: as in the input.
MapChannel map_channel(std::string name, const NewChannel& from, SampleType type) {
  Image image(from.image->width(), from.image->height(), 1);
  for (std::size_t i = 0; i < image.pixels(); ++i) image.plane(0)[i] = from.at(i);
  return {std::move(name), std::move(image), type == SampleType::Half};
}

SampleType type_of(const PartInfo& part, const std::string& channel) {
  const auto found = std::find_if(part.channels.begin(), part.channels.end(),
                                  [&](const ChannelInfo& info) { return info.name == channel; });
  return found == part.channels.end() ? SampleType::Float : found->type;
}

/// Writes the replaced layers alone into a new EXR file, for inputs of other formats.
std::vector<std::string> write_as_exr(const FrameSource& source, const std::vector<Replacement>& replacements,
                                      const std::string& target, const WriteOptions& options) {
  const PartInfo& part = source.files.front().parts.front();
  std::vector<MapChannel> channels;
  for (const Replacement& replacement : replacements) {
    const Layer& layer = layer_named(source, replacement.layer);
    const auto names = channels_to_replace(layer, replacement);
    const bool mean = names.size() == 1 && replacement.image.channels() == 3;
    for (std::size_t c = 0; c < names.size(); ++c)
      channels.push_back(
          map_channel(names[c], {&replacement.image, {}, static_cast<int>(c), mean, {}}, type_of(part, names[c])));
  }
  for (const Addition& addition : options.additions) {
    const Layer& layer = layer_named(source, addition.layer);
    channels.push_back(map_channel(name_beside(layer, layer.channels.front(), addition.suffix, "X"),
                                   {&addition.image, {}, 0, false, {}}, SampleType::Float));
  }
  MapAttributes attributes;
  attributes.strings = {{settings_attribute, options.provenance.settings}, {input_attribute, options.provenance.input}};
  if (options.provenance.estimated_relative_mse >= 0)
    attributes.numbers = {{error_attribute, options.provenance.estimated_relative_mse}};
  write_maps(target, channels, part.data_window, part.display_window, attributes, options.encoding);
  return {fmt::format("{} is no OpenEXR file: the result is written as one, with the reconstructed layers only",
                      source.path)};
}

}  // namespace

std::vector<std::string> write_result(const FrameSource& source, const std::vector<Replacement>& replacements,
                                      const std::string& target, const WriteOptions& options) {
  const bool is_exr = source.files.front().format == "openexr";
  return (is_exr ? rewrite_file : write_as_exr)(source, replacements, target, options);
}

}  // namespace polyrecon
