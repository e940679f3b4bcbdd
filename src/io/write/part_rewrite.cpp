#include "io/write/part_rewrite.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

#include "io/exr/attributes.h"
#include "io/exr/compression.h"
#include "io/exr/encode.h"
#include "io/layers/channel_groups.h"
#include "io/layers/channel_names.h"
#include "io/renderers/polyrecon.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

Rect window_of(const Imf::Header& header) {
  const auto& window = header.dataWindow();
  return {window.min.x, window.min.y, window.max.x + 1, window.max.y + 1};
}

bool is_working(const Layer& layer) { return layer.companion != Companion::Mean || layer.role == Role::SampleCount; }

void add_replacement(const FrameSource& source, const Replacement& replacement, const WriteOptions& options,
                     std::vector<PartRewrite>& parts) {
  const Layer& layer = layer_named(source, replacement.layer);
  PartRewrite& part = parts[static_cast<std::size_t>(layer.part)];
  const Rect window = replacement.window.empty() ? window_of(part.header) : replacement.window;
  const auto channels = channels_to_replace(layer, replacement);
  const Image& image = replacement.image;
  const bool one_of_three = channels.size() == 1 && image.channels() == 3;
  const bool fits = static_cast<std::size_t>(image.channels()) == channels.size() || one_of_three;
  const bool repeated = image.channels() == 1;
  if (image.width() != window.width() || image.height() != window.height() || (!fits && !repeated))
    throw Error(ExitCode::Internal,
                fmt::format("{}: the new image does not have the shape of layer {}", source.path, layer.name));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    NewChannel channel{&image, window, repeated ? 0 : static_cast<int>(c), one_of_three, {}};
    if (options.keep_noisy) {
      channel.noisy_name = name_beside(layer, channels[c], noisy_suffix, word_of(layer, channels[c]));
      part.header.channels().insert(channel.noisy_name, *part.header.channels().findChannel(channels[c]));
    }
    part.replaced[channels[c]] = std::move(channel);
  }
}

void add_addition(const FrameSource& source, const Addition& addition, std::vector<PartRewrite>& parts) {
  const Layer& layer = layer_named(source, addition.layer);
  PartRewrite& part = parts[static_cast<std::size_t>(layer.part)];
  const Rect window = addition.window.empty() ? window_of(part.header) : addition.window;
  if (addition.image.width() != window.width() || addition.image.height() != window.height())
    throw Error(ExitCode::Internal,
                fmt::format("{}: the image for {}{} has another size", source.path, layer.name, addition.suffix));
  // OpenEXR's lossy compressions take a channel Y for a colour.
  const std::string name = name_beside(layer, layer.channels.front(), addition.suffix, "X");
  part.header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  part.replaced[name] = {&addition.image, window, 0, false, {}};
}

/// Removes channels from a part. One that cannot be encoded again loses all or none.
void remove_channels(Imf::Header& header, const std::set<std::string>& dropped) {
  Imf::ChannelList kept;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    if (dropped.count(c.name()) == 0) kept.insert(c.name(), c.channel());
  if (is_plain(header) || kept.begin() == kept.end()) header.channels() = kept;
}

/// Removes what the options do not keep. Layers with a replaced channel stay as they are.
void remove_layers(const FrameSource& source, const WriteOptions& options, std::vector<PartRewrite>& parts) {
  std::vector<std::set<std::string>> dropped(parts.size());
  for (const Layer& layer : source.layers) {
    if (layer.file != 0 || (is_working(layer) ? options.keep_working : options.keep_layers)) continue;
    const auto part = static_cast<std::size_t>(layer.part);
    std::vector<std::string> channels = layer.channels;
    if (!layer.alpha.empty()) channels.push_back(layer.alpha);
    if (std::none_of(channels.begin(), channels.end(),
                     [&](const std::string& channel) { return parts[part].replaced.count(channel) > 0; }))
      dropped[part].insert(channels.begin(), channels.end());
  }
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (!dropped[p].empty()) remove_channels(parts[p].header, dropped[p]);
  parts.erase(std::remove_if(parts.begin(), parts.end(),
                             [](const PartRewrite& part) {
                               return part.header.channels().begin() == part.header.channels().end();
                             }),
              parts.end());
}

/// The channels of a part that no compression may change: all but those of layers that may change.
std::set<std::string> exact_channels(const FrameSource& source, const PartRewrite& part) {
  std::set<std::string> exact;
  for (auto c = part.header.channels().begin(); c != part.header.channels().end(); ++c) exact.insert(c.name());
  for (const Layer& layer : source.layers) {
    if (layer.file != 0 || layer.part != part.input || !may_lose_precision(layer)) continue;
    for (const std::string& channel : layer.channels) exact.erase(channel);
    exact.erase(layer.alpha);
  }
  for (const auto& [name, channel] : part.replaced)
    if (!channel.noisy_name.empty() && exact.count(name) == 0) exact.erase(channel.noisy_name);
  return exact;
}

void add_provenance(Imf::Header& header, const Provenance& provenance) {
  set_attribute(header, version_attribute, Imf::StringAttribute(POLYRECON_VERSION));
  if (!provenance.settings.empty())
    set_attribute(header, settings_attribute, Imf::StringAttribute(provenance.settings));
  if (!provenance.input.empty()) set_attribute(header, input_attribute, Imf::StringAttribute(provenance.input));
  if (provenance.estimated_relative_mse >= 0)
    set_attribute(header, error_attribute, Imf::FloatAttribute(static_cast<float>(provenance.estimated_relative_mse)));
}

/// Removes an attribute that OpenEXR takes for the description of tiles from the header of scanlines.
void remove_stray_tiles(Imf::Header& header) {
  if (header.hasType() && !Imf::isTiled(header.type())) header.erase("tiles");
}

std::string upper_case_name(const Imf::Header& header) {
  std::string name = compression_name(header.compression());
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name;
}

/// Decides how a part is packed. Returns a note where it is not as requested, or not as in the input.
std::string choose_encoding(const FrameSource& source, const Encoding& encoding, const Imf::Header& input,
                            PartRewrite& part) {
  const std::string title = part_title(input, part.input);
  const bool same_channels = part.replaced.empty() && part.header.channels() == input.channels();
  if (!encoding.compression) {
    part.copied_raw = same_channels;
    if (same_channels || changed_channels(input).empty()) {
      part.header.zipCompressionLevel() = zip_level;
      return {};
    }
    encode(part.header, {Compression::Zip}, {});
    return fmt::format("{} is written with ZIP: its lossy compression would change the other channels again", title);
  }
  const bool requested = static_cast<int>(input.compression()) == static_cast<int>(*encoding.compression);
  part.copied_raw = same_channels && (requested || !is_plain(input));
  if (part.copied_raw)
    return requested ? ""
                     : fmt::format("{} keeps {}: only flat images of one level are packed anew", title,
                                   upper_case_name(input));
  const std::string kept = encode(part.header, encoding, exact_channels(source, part));
  if (kept.empty()) return {};
  Imf::Header lossy = part.header;
  lossy.compression() = static_cast<Imf::Compression>(*encoding.compression);
  return fmt::format(
      "{} is written with ZIP: {} would change {}, which is no colour; leave it out with --outputs, or "
      "render it into a file of its own",
      title, upper_case_name(lossy), kept);
}

}  // namespace

const Layer& layer_named(const FrameSource& source, const std::string& name) {
  const auto found =
      std::find_if(source.layers.begin(), source.layers.end(), [&](const Layer& l) { return l.name == name; });
  if (found == source.layers.end() || found->file != 0)
    throw Error(ExitCode::Missing, fmt::format("{}: no layer {} in this file to be replaced", source.path, name));
  return *found;
}

std::string name_beside(const Layer& layer, const std::string& channel, const std::string& suffix,
                        const std::string& last_word) {
  const auto dot = channel.rfind('.');
  const std::string word = "." + last_word, pass = layer.pass + suffix;
  if (dot == std::string::npos) return pass + word;
  const std::string prefix = channel.substr(0, dot);
  const bool has_view_behind = !layer.view.empty() && prefix.substr(prefix.rfind('.') + 1) == layer.view;
  if (!has_view_behind) return prefix + suffix + word;
  return (layer.view_layer.empty() ? "" : layer.view_layer + ".") + pass + "." + layer.view + word;
}

std::vector<std::string> channels_to_replace(const Layer& layer, const Replacement& replacement) {
  if (replacement.alpha && !layer.alpha.empty()) return {layer.alpha};
  return layer.channels;
}

std::vector<PartRewrite> plan_parts(const FrameSource& source, const std::vector<Imf::Header>& input,
                                    const std::vector<Replacement>& replacements, const WriteOptions& options,
                                    std::vector<std::string>& notes) {
  std::vector<PartRewrite> parts;
  for (std::size_t p = 0; p < input.size(); ++p) parts.push_back({static_cast<int>(p), input[p], {}});
  for (const Replacement& replacement : replacements) add_replacement(source, replacement, options, parts);
  for (const Addition& addition : options.additions) add_addition(source, addition, parts);
  remove_layers(source, options, parts);
  for (PartRewrite& part : parts) {
    remove_stray_tiles(part.header);
    const std::string note =
        choose_encoding(source, options.encoding, input[static_cast<std::size_t>(part.input)], part);
    if (!note.empty()) notes.push_back(note);
  }
  add_provenance(parts.front().header, options.provenance);
  return parts;
}

bool is_plain(const Imf::Header& header) {
  bool plain = !Imf::isDeepData(header.type());
  if (Imf::isTiled(header.type())) plain = plain && header.tileDescription().mode == Imf::ONE_LEVEL;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    plain = plain && c.channel().xSampling == 1 && c.channel().ySampling == 1;
  return plain;
}

std::string part_title(const Imf::Header& header, int part) {
  return header.hasName() ? fmt::format("part {} \"{}\"", part, header.name()) : fmt::format("part {}", part);
}

}  // namespace polyrecon
