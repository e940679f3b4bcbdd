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
#include "io/exr/compression.h"
#include "io/exr/encode.h"
#include "io/exr/writable.h"
#include "io/layers/channel_groups.h"
#include "io/layers/channel_names.h"
#include "io/renderers/known_names.h"
#include "io/renderers/polyrecon.h"

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

Imf::PixelType type_in_file(const Render& first, const Layer& layer, const std::string& channel) {
  for (const ChannelInfo& info : part_of(first, layer).channels)
    if (info.name == channel)
      return info.type == SampleType::Half ? Imf::HALF : info.type == SampleType::Uint ? Imf::UINT : Imf::FLOAT;
  return Imf::FLOAT;
}

/// A mean is more precise than the renders, and rounded means of layers would no longer add up. Joined regions are
/// copies.
Imf::PixelType type_of_mean(const MergeTask& task, const Layer& layer, const std::string& channel) {
  return task.joins && type_in_file(task.first(), layer, channel) == Imf::HALF ? Imf::HALF : Imf::FLOAT;
}

Imf::ChannelList output_channels(const MergeTask& task) {
  Imf::ChannelList list;
  for (const std::size_t l : task.merged) {
    const Layer& layer = task.first().layers[l];
    for (const std::string& name : layer.channels)
      for (const char* companion : output_companions)
        if (!task.joins || *companion == 0)
          list.insert(output_name(task.first(), layer, name, companion),
                      Imf::Channel(*companion == 0 ? type_of_mean(task, layer, name) : Imf::FLOAT));
    if (!layer.alpha.empty())
      list.insert(output_name(task.first(), layer, layer.alpha), Imf::Channel(type_of_mean(task, layer, layer.alpha)));
  }
  for (const std::size_t l : task.kept) {
    const Layer& layer = task.first().layers[l];
    for (const std::string& name : all_channels(layer))
      list.insert(output_name(task.first(), layer, name), Imf::Channel(type_in_file(task.first(), layer, name)));
  }
  for (const std::string& view_layer : task.counted) list.insert(count_name(view_layer), Imf::Channel(Imf::FLOAT));
  return list;
}

/// The channels that no compression may change: all but joined colours, as halves and variances are the noise of means.
std::set<std::string> exact_channels(const MergeTask& task, const Imf::Header& header) {
  std::set<std::string> exact;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) exact.insert(c.name());
  for (const Layer& layer : task.first().layers)
    if (may_lose_precision(layer))
      for (const std::string& name : all_channels(layer)) exact.erase(output_name(task.first(), layer, name));
  return exact;
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

Imf::Header output_header(const MergeTask& task, const Encoding& encoding, std::vector<std::string>& notes) {
  const Imf::MultiPartInputFile input(path_of(task.first()).c_str(), 0, false);
  Imf::Header header(input.header(0).displayWindow(),
                     {{task.window.x0, task.window.y0}, {task.window.x1 - 1, task.window.y1 - 1}});
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = Imf::ZIP_COMPRESSION;
  copy_metadata(input, header);
  header.channels() = output_channels(task);
  if (const std::string channel = encode(header, encoding, exact_channels(task, header)); !channel.empty())
    notes.push_back(fmt::format("written with ZIP: {} would change {}, which is no colour",
                                compression_name(static_cast<int>(*encoding.compression)), channel));
  if (const auto views = stereo_views(task); !views.empty()) Imf::addMultiView(header, views);
  for (const auto& [view_layer, samples] : task.metadata_samples) {
    for (const SamplesAttribute& copied : samples_attributes(view_layer)) replace_number(header, copied.name, samples);
    set_attribute(header, with_view_layer(samples_attribute, view_layer),
                  Imf::FloatAttribute(static_cast<float>(samples)));
  }
  set_attribute(header, version_attribute, Imf::StringAttribute(POLYRECON_VERSION));
  if (!task.shared_samples.empty())
    set_attribute(header, shared_samples_attribute, Imf::StringAttribute(task.shared_samples));
  require_writable(path_of(task.first()), {header});
  return header;
}

}  // namespace polyrecon
