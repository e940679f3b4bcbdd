#include "io/merge/output.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "io/exr/attributes.h"
#include "io/exr/bands.h"
#include "io/exr/writable.h"
#include "io/layers/channel_groups.h"
#include "io/layers/channel_names.h"
#include "io/renderers/known_names.h"

namespace polyrecon {
namespace {

/// Copies the attributes of all parts except those that describe the storage. The first part that has an attribute
/// decides.
void copy_metadata(const Imf::MultiPartInputFile& input, Imf::Header& header) {
  static const std::set<std::string> storage{"name",       "type",       "view",          "channels",
                                             "chunkCount", "tiles",      "version",       "compression",
                                             "lineOrder",  "dataWindow", "displayWindow", "maxSamplesPerPixel"};
  std::set<std::string> copied = storage;
  for (int p = 0; p < input.parts(); ++p)
    for (auto a = input.header(p).begin(); a != input.header(p).end(); ++a)
      if (copied.insert(a.name()).second) header.insert(a.name(), a.attribute());
}

/// Writes a number into an attribute, whatever its type; nothing where the header has no such attribute.
void replace_number(Imf::Header& header, const std::string& name, double value) {
  if (auto* text = header.findTypedAttribute<Imf::StringAttribute>(name)) text->value() = fmt::format("{:.0f}", value);
  if (auto* whole = header.findTypedAttribute<Imf::IntAttribute>(name))
    whole->value() = static_cast<int>(std::min<double>(std::round(value), std::numeric_limits<int>::max()));
  if (auto* real = header.findTypedAttribute<Imf::FloatAttribute>(name)) real->value() = static_cast<float>(value);
  if (auto* real = header.findTypedAttribute<Imf::DoubleAttribute>(name)) real->value() = value;
}

Imf::ChannelList output_channels(const MergeTask& task) {
  Imf::ChannelList list;
  for (const std::size_t l : task.merged) {
    const Layer& layer = task.first().layers[l];
    for (const std::string& name : layer.channels)
      for (const char* companion : output_companions)
        if (!task.joins || *companion == 0)
          list.insert(output_name(task.first(), layer, name, companion), Imf::Channel(Imf::FLOAT));
    if (!layer.alpha.empty()) list.insert(output_name(task.first(), layer, layer.alpha), Imf::Channel(Imf::FLOAT));
  }
  for (const std::size_t l : task.kept) {
    const Layer& layer = task.first().layers[l];
    for (const ChannelInfo& channel : part_of(task.first(), layer).channels) {
      const auto mine = all_channels(layer);
      if (std::find(mine.begin(), mine.end(), channel.name) == mine.end()) continue;
      const auto type = channel.type == SampleType::Half   ? Imf::HALF
                        : channel.type == SampleType::Uint ? Imf::UINT
                                                           : Imf::FLOAT;
      list.insert(output_name(task.first(), layer, channel.name), Imf::Channel(type));
    }
  }
  for (const std::string& view_layer : task.counted) list.insert(count_name(view_layer), Imf::Channel(Imf::FLOAT));
  return list;
}

Imf::StringVector stereo_views(const MergeTask& task) {
  Imf::StringVector views;
  for (const Layer& layer : task.first().layers)
    if (!layer.view.empty() && std::find(views.begin(), views.end(), layer.view) == views.end())
      views.push_back(layer.view);
  return views;
}

}  // namespace

std::string output_name(const Render& first, const Layer& layer, const std::string& channel,
                        const std::string& companion) {
  const bool one_file = first.files.size() == 1;
  if (one_file && first.files.front().parts.size() == 1 && companion.empty()) return channel;
  std::string name = layer.view_layer.empty() ? "" : layer.view_layer + ".";
  // A pass from a file's name has what separates it from the rest of that name in front.
  name += (one_file ? layer.pass : layer.pass.substr(layer.pass.find_first_not_of("_- "))) + companion;
  if (!layer.view.empty()) name += "." + layer.view;
  return name + "." + word_of(layer, channel);
}

std::string count_name(const std::string& view_layer) {
  return (view_layer.empty() ? "" : view_layer + ".") + sample_count_pass + ".X";
}

Imf::Header output_header(const MergeTask& task, bool compress) {
  const Imf::MultiPartInputFile input(path_of(task.first()).c_str(), 0, false);
  Imf::Header header(input.header(0).displayWindow(),
                     {{task.window.x0, task.window.y0}, {task.window.x1 - 1, task.window.y1 - 1}});
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = compress ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
  header.zipCompressionLevel() = zip_level;
  copy_metadata(input, header);
  header.channels() = output_channels(task);
  if (const auto views = stereo_views(task); !views.empty()) Imf::addMultiView(header, views);
  for (const auto& [view_layer, samples] : task.metadata_samples) {
    for (const SamplesAttribute& copied : samples_attributes(view_layer)) replace_number(header, copied.name, samples);
    set_attribute(header, with_view_layer(samples_attribute, view_layer),
                  Imf::FloatAttribute(static_cast<float>(samples)));
  }
  set_attribute(header, "polyrecon/version", Imf::StringAttribute(POLYRECON_VERSION));
  if (!task.shared_samples.empty())
    set_attribute(header, shared_samples_attribute, Imf::StringAttribute(task.shared_samples));
  require_writable(path_of(task.first()), {header});
  return header;
}

}  // namespace polyrecon
