#include "polyrecon/write_result.h"

#include <Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfDeepTiledInputPart.h>
#include <OpenEXR/ImfDeepTiledOutputPart.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/first_line.h"
#include "core/rect.h"
#include "io/exr/attributes.h"
#include "io/exr/bands.h"
#include "io/exr/compression.h"
#include "io/exr/encode.h"
#include "io/exr/out_of_memory.h"
#include "io/exr/raw.h"
#include "io/exr/writable.h"
#include "io/files/atomic_file.h"
#include "io/files/file_identity.h"
#include "io/files/single_part.h"
#include "io/layers/channel_groups.h"
#include "io/layers/channel_names.h"
#include "io/renderers/polyrecon.h"
#include "io/values/beyond_range.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// The source of a channel's new samples: a plane of an image, or the mean of all its planes.
struct NewChannel {
  const Image* image = nullptr;
  Rect window;  ///< Place of the image.
  int plane = 0;
  bool mean = false;
  std::string noisy_name;  ///< Channel for the old samples; empty where they are not kept.

  float at(std::size_t i) const {
    if (!mean) return static_cast<float>(image->plane(plane)[i]);
    double sum = 0;
    for (int c = 0; c < image->channels(); ++c) sum += image->plane(c)[i];
    return static_cast<float>(sum / image->channels());
  }
};

using NewChannels = std::map<std::string, NewChannel>;  ///< The key is the whole name of the channel.

/// How one part is written.
struct PartRewrite {
  int input;  ///< Its index in the input.
  Imf::Header header;
  NewChannels replaced;     ///< New samples, of channels of the input or of others.
  bool copied_raw = false;  ///< Chunk by chunk.
};

const Layer& layer_named(const FrameSource& source, const std::string& name) {
  const auto found =
      std::find_if(source.layers.begin(), source.layers.end(), [&](const Layer& l) { return l.name == name; });
  if (found == source.layers.end() || found->file != 0)
    throw Error(ExitCode::Missing, fmt::format("{}: no layer {} in this file to be replaced", source.path, name));
  return *found;
}

/// The name of a channel of the layer that stands next to `layer`: with the suffix " Noisy", "ViewLayer.Combined.R"
/// becomes "ViewLayer.Combined Noisy.R", and "Combined.right.R" "Combined Noisy.right.R". A channel without a layer
/// gets the layer's pass in front.
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

/// Whether the samples of a part can be decoded and encoded again: a flat image of one level, with all its samples.
bool is_plain(const Imf::Header& header) {
  bool plain = !Imf::isDeepData(header.type());
  if (Imf::isTiled(header.type())) plain = plain && header.tileDescription().mode == Imf::ONE_LEVEL;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    plain = plain && c.channel().xSampling == 1 && c.channel().ySampling == 1;
  return plain;
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
  set_attribute(header, "polyrecon/version", Imf::StringAttribute(POLYRECON_VERSION));
  if (!provenance.settings.empty())
    set_attribute(header, settings_attribute, Imf::StringAttribute(provenance.settings));
  if (!provenance.input.empty()) set_attribute(header, "polyrecon/input", Imf::StringAttribute(provenance.input));
  if (provenance.estimated_relative_mse >= 0)
    set_attribute(header, "polyrecon/estimatedRelMSE",
                  Imf::FloatAttribute(static_cast<float>(provenance.estimated_relative_mse)));
}

/// Removes an attribute that OpenEXR takes for the description of tiles from the header of scanlines.
void remove_stray_tiles(Imf::Header& header) {
  if (header.hasType() && !Imf::isTiled(header.type())) header.erase("tiles");
}

/// Stores a value as the channel's type. Counts half values that were out of range and are saturated.
void store(NativeChannel& channel, std::size_t i, float value, std::size_t& saturated) {
  if (channel.type == Imf::HALF) {
    if (std::abs(value) > largest_half) {
      value = std::copysign(largest_half, value);
      ++saturated;
    }
    const half h(value);
    std::memcpy(channel.samples.data() + i * sizeof h, &h, sizeof h);
  } else if (channel.type == Imf::FLOAT) {
    std::memcpy(channel.samples.data() + i * sizeof value, &value, sizeof value);
  } else {
    const double whole = std::isfinite(value) ? std::round(std::max(value, 0.0f)) : 0;
    const auto u = static_cast<unsigned int>(std::min<double>(whole, std::numeric_limits<unsigned int>::max()));
    std::memcpy(channel.samples.data() + i * sizeof u, &u, sizeof u);
  }
}

/// Makes a band of the output from one of the input: copies the samples, moves replaced ones to their noisy names and
/// puts the new ones in their place.
void apply(const NewChannels& replaced, NativeBand& old, NativeBand& band, std::size_t& saturated) {
  for (NativeChannel& channel : band.channels)
    if (NativeChannel* same = old.find(channel.name)) channel.samples.swap(same->samples);
  const Rect lines{old.x0, old.y0, old.x0 + old.width, old.y1};
  for (const auto& [name, source] : replaced) {
    NativeChannel* channel = band.find(name);
    if (!old.find(name)) std::fill(channel->samples.begin(), channel->samples.end(), 0);
    if (!source.noisy_name.empty()) band.find(source.noisy_name)->samples = channel->samples;
    const Rect covered = intersect(lines, source.window);
    for (int y = covered.y0; y < covered.y1; ++y) {
      const std::size_t to = static_cast<std::size_t>(y - lines.y0) * static_cast<std::size_t>(old.width) +
                             static_cast<std::size_t>(covered.x0 - lines.x0);
      const std::size_t from = source.image->index(covered.x0 - source.window.x0, y - source.window.y0);
      for (std::size_t k = 0; k < static_cast<std::size_t>(covered.width()); ++k)
        store(*channel, to + k, source.at(from + k), saturated);
    }
  }
}

std::string part_title(const Imf::Header& header, int part) {
  return header.hasName() ? fmt::format("part {} \"{}\"", part, header.name()) : fmt::format("part {}", part);
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

/// A file that is written again with changes. write() and verify() are the two steps of write_atomically.
class Rewrite {
 public:
  Rewrite(const FrameSource& source, const std::vector<Replacement>& replacements, const WriteOptions& options)
      : path_(source.path), input_(source.path.c_str(), Imf::globalThreadCount(), false) {
    for (int p = 0; p < input_.parts(); ++p) parts_.push_back({p, input_.header(p), {}});
    for (const Replacement& replacement : replacements) add_replacement(source, replacement, options, parts_);
    for (const Addition& addition : options.additions) add_addition(source, addition, parts_);
    remove_layers(source, options, parts_);
    for (PartRewrite& part : parts_) {
      remove_stray_tiles(part.header);
      const std::string note = choose_encoding(source, options.encoding, input_.header(part.input), part);
      if (!note.empty()) notes_.push_back(note);
    }
    add_provenance(parts_.front().header, options.provenance);
    require_writable(path_, headers());
  }

  void write(const std::string& path) {
    const std::vector<Imf::Header> written = headers();
    saturated_ = shortened_ = 0;
    checks_.clear();
    Imf::MultiPartOutputFile output(path.c_str(), written.data(), static_cast<int>(written.size()), true);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      checks_.emplace_back(parts_[p].header);
      parts_[p].copied_raw ? copy_part(output, p) : write_changed(output, p);
    }
    if (saturated_ > 0)
      notes_.push_back(fmt::format("{} half samples were beyond {} and are written as that", saturated_, largest_half));
    if (shortened_ > 0)
      notes_.push_back(
          fmt::format("{} samples beyond {} are written as that, since the lossy compression could make "
                      "them infinite",
                      shortened_, largest_changed_sample));
  }

  void verify(const std::string& path) {
    input_.flushPartCache();  // copying opened tiled parts as tiled, and the cache would keep them so
    Imf::MultiPartInputFile written(path.c_str(), Imf::globalThreadCount(), false);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const PartRewrite& part = parts_[p];
      const bool same =
          part.copied_raw ? same_chunks(path_, part.input, path, static_cast<int>(p)) : same_samples(written, p);
      if (!same)
        throw std::runtime_error(fmt::format("{} differs when it is read back", part_title(part.header, part.input)));
      if (part.copied_raw) decode(part);
    }
  }

  std::vector<std::string> take_notes() { return std::move(notes_); }

 private:
  std::vector<Imf::Header> headers() const {
    std::vector<Imf::Header> all;
    for (const PartRewrite& part : parts_) all.push_back(part.header);
    return all;
  }

  void copy_part(Imf::MultiPartOutputFile& output, std::size_t p) {
    const int from = parts_[p].input;
    try {
      copy_raw(output, from, static_cast<int>(p));
    } catch (const Iex::InputExc& problem) {
      throw_if_out_of_memory(problem);
      throw Error(ExitCode::BadInput, fmt::format("{}: incomplete or damaged: {} cannot be copied ({})", path_,
                                                  part_title(input_.header(from), from), first_line(problem.what())));
    }
  }

  void copy_raw(Imf::MultiPartOutputFile& output, int source, int target) {
    const std::string& type = input_.header(source).type();
    if (type == Imf::DEEPSCANLINE) {
      Imf::DeepScanLineInputPart from(input_, source);
      Imf::DeepScanLineOutputPart(output, target).copyPixels(from);
    } else if (type == Imf::DEEPTILE) {
      Imf::DeepTiledInputPart from(input_, source);
      Imf::DeepTiledOutputPart(output, target).copyPixels(from);
    } else if (type == Imf::TILEDIMAGE) {
      Imf::TiledInputPart from(input_, source);
      Imf::TiledOutputPart(output, target).copyPixels(from);
    } else {
      Imf::InputPart from(input_, source);
      Imf::OutputPart(output, target).copyPixels(from);
    }
  }

  /// Makes `band` of the output. `old` is a band of the input, whose memory is used.
  void make_band(Imf::InputPart& from, const PartRewrite& part, NativeBand& old, NativeBand& band,
                 std::size_t& saturated) {
    old.take_lines(band.y0, band.y1);
    try {
      read_band(from, old);
    } catch (const Iex::BaseExc& problem) {
      throw_if_out_of_memory(problem);
      throw Error(ExitCode::BadInput,
                  fmt::format("{}: incomplete or damaged: {} cannot be read at scanlines {} to {} ({})", path_,
                              part_title(input_.header(part.input), part.input), old.y0, old.y1 - 1,
                              first_line(problem.what())));
    }
    apply(part.replaced, old, band, saturated);
  }

  void write_changed(Imf::MultiPartOutputFile& output, std::size_t p) {
    const PartRewrite& part = parts_[p];
    Imf::InputPart from(input_, part.input);
    NativeBand old(input_.header(part.input));
    write_bands(output, static_cast<int>(p), [&](NativeBand& band) {
      make_band(from, part, old, band, saturated_);
      shortened_ += checks_[p].keep_in_range(band);
      checks_[p].remember(band);
    });
  }

  /// Decodes every band of the written part and compares it with what was written.
  bool same_samples(Imf::MultiPartInputFile& written, std::size_t p) {
    Imf::InputPart back(written, static_cast<int>(p));
    NativeBand found(back.header());
    for (const auto& [y0, y1] : bands_of(back.header())) {
      found.take_lines(y0, y1);
      read_band(back, found);
      if (checks_[p].first_mismatch(found)) return false;
    }
    return true;
  }

  /// Decodes a part that was copied chunk by chunk, so that damage in it is reported.
  void decode(const PartRewrite& part) {
    const Imf::Header& header = input_.header(part.input);
    if (!is_plain(header)) return;
    Imf::InputPart from(input_, part.input);
    std::size_t ignored = 0;
    NativeBand old(header), band(header);
    for (const auto& [y0, y1] : bands_of(header)) {
      band.take_lines(y0, y1);
      make_band(from, part, old, band, ignored);
    }
  }

  std::string path_;
  Imf::MultiPartInputFile input_;
  std::vector<PartRewrite> parts_;
  std::size_t saturated_ = 0, shortened_ = 0;
  std::vector<BandCheck> checks_;  ///< For each part.
  std::vector<std::string> notes_;
};

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
  attributes.strings = {{settings_attribute, options.provenance.settings},
                        {"polyrecon/input", options.provenance.input}};
  if (options.provenance.estimated_relative_mse >= 0)
    attributes.numbers = {{"polyrecon/estimatedRelMSE", options.provenance.estimated_relative_mse}};
  write_maps(target, channels, part.data_window, part.display_window, attributes, options.encoding);
  return {fmt::format("{} is no OpenEXR file: the result is written as one, with the reconstructed layers only",
                      source.path)};
}

Imath::Box2i to_box(const Rect& r) { return {{r.x0, r.y0}, {r.x1 - 1, r.y1 - 1}}; }

Imf::Header map_header(const std::vector<MapChannel>& channels, const Rect& data_window, const Rect& display_window,
                       const MapAttributes& attributes, const Encoding& encoding) {
  Imf::Header header(to_box(display_window), to_box(data_window));
  header.compression() = Imf::ZIP_COMPRESSION;
  header.setType(Imf::SCANLINEIMAGE);
  for (const MapChannel& channel : channels)
    header.channels().insert(channel.name, Imf::Channel(channel.is_half ? Imf::HALF : Imf::FLOAT));
  encode(header, encoding, {});
  header.insert("polyrecon/version", Imf::StringAttribute(POLYRECON_VERSION));
  for (const auto& [name, text] : attributes.strings)
    if (!text.empty()) header.insert(name, Imf::StringAttribute(text));
  for (const auto& [name, number] : attributes.numbers)
    header.insert(name, Imf::FloatAttribute(static_cast<float>(number)));
  return header;
}

void fill_map_band(const std::vector<MapChannel>& channels, const Rect& data_window, NativeBand& band) {
  std::size_t ignored = 0;
  const std::size_t begin = static_cast<std::size_t>(band.y0 - data_window.y0) * static_cast<std::size_t>(band.width);
  const std::size_t pixels = static_cast<std::size_t>(band.y1 - band.y0) * static_cast<std::size_t>(band.width);
  for (const MapChannel& from : channels) {
    NativeChannel* to = band.find(from.name);
    for (std::size_t i = 0; i < pixels; ++i) store(*to, i, static_cast<float>(from.image.plane(0)[begin + i]), ignored);
  }
}

}  // namespace

std::vector<std::string> write_result(const FrameSource& source, const std::vector<Replacement>& replacements,
                                      const std::string& target, const WriteOptions& options) {
  if (source.files.front().format != "openexr") return write_as_exr(source, replacements, target, options);
  const FileInfo& input = source.files.front();  // it is read a second time
  require_unchanged(input);
  Rewrite rewrite(source, replacements, options);
  const auto verify = [&](const std::string& path) {
    rewrite.verify(path);
    require_unchanged(input);
  };
  write_atomically(
      target, [&](const std::string& path) { rewrite.write(path); }, verify);
  return rewrite.take_notes();
}

void write_maps(const std::string& target, const std::vector<MapChannel>& channels, const Rect& data_window,
                const Rect& display_window, const MapAttributes& attributes, const Encoding& encoding) {
  write_single_part(target, map_header(channels, data_window, display_window, attributes, encoding),
                    [&](NativeBand& band) { fill_map_band(channels, data_window, band); });
}

}  // namespace polyrecon
