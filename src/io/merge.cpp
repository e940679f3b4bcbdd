#include "polyrecon/merge.h"

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
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include "core/parallel.h"
#include "core/rect.h"
#include "io/beyond_range.h"
#include "io/channel_groups.h"
#include "io/channel_names.h"
#include "io/channel_reader.h"
#include "io/choose_layers.h"
#include "io/exr/bands.h"
#include "io/exr/single_part.h"
#include "io/half_split.h"
#include "io/merge_regions.h"
#include "io/merge_sums.h"
#include "io/renderers/known_names.h"
#include "io/renderers/polyrecon.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr std::size_t sums_at_once = std::size_t{1} << 18;
constexpr int chunk_lines = 32;
/// Samples of a render over the number of the other renders, up to which a sample that all have in common matters: with
/// 4 renders of 16 samples the error of a textured plane is 1.4 times what their variance says.
constexpr double longest_shared = 8;
constexpr double most_single_cover = 0.05;   ///< Share of the picture with one render, beyond which noise is not known.
constexpr std::size_t renders_at_once = 16;  ///< Renders that are decoded before they are added up.
constexpr std::size_t pixels_at_once = std::size_t{1} << 12;  ///< Pixels of one channel whose sums stay in the cache.

/// One render. Its layers are in the order of the first render's.
struct Render {
  std::vector<FileInfo> files;  ///< [0] is the named one; the others hold its other passes.
  std::vector<Layer> layers;
  std::vector<bool> absent;  ///< For each layer whether only the first render has it; empty for the first render.
  Rect window;               ///< The data windows of all parts together.
  Region region;             ///< The pixels it has samples for.
};

const std::string& path_of(const Render& render) { return render.files.front().path; }

const FileInfo& file_of(const Render& render, const Layer& layer) {
  return render.files[static_cast<std::size_t>(layer.file)];
}

const PartInfo& part_of(const Render& render, const Layer& layer) {
  return file_of(render, layer).parts[static_cast<std::size_t>(layer.part)];
}

[[noreturn]] void misfit(const Render& render, const Render& first, const std::string& what) {
  throw Error(ExitCode::BadInput, fmt::format("{}: does not fit {}: {}", path_of(render), path_of(first), what));
}

/// Checks that a render has the layers of the first one, and brings its layers into the same order.
void check_fits(Render& render, const Render& first) {
  std::vector<Layer> ordered;
  for (const Layer& layer : first.layers) {
    const auto same =
        std::find_if(render.layers.begin(), render.layers.end(), [&](const Layer& l) { return l.name == layer.name; });
    render.absent.push_back(same == render.layers.end());
    if (render.absent.back()) {
      ordered.push_back(layer);
      continue;
    }
    if (same->channels.size() != layer.channels.size() || same->alpha.empty() != layer.alpha.empty())
      misfit(render, first, fmt::format("other channels in layer {}", layer.name));
    if (!(part_of(render, *same).display_window == part_of(first, layer).display_window))
      misfit(render, first, "another display window, so that its place in the picture is unknown");
    ordered.push_back(*same);
  }
  for (const Layer& layer : render.layers)
    if (std::none_of(first.layers.begin(), first.layers.end(), [&](const Layer& l) { return l.name == layer.name; }))
      misfit(render, first, fmt::format("a further layer {}", layer.name));
  render.layers = std::move(ordered);
}

/// What becomes of a layer.
enum class Fate { Merged, Kept, Dropped };

/// The channels of a layer, its alpha last.
std::vector<std::string> all_channels(const Layer& layer) {
  std::vector<std::string> channels = layer.channels;
  if (!layer.alpha.empty()) channels.push_back(layer.alpha);
  return channels;
}

bool all_uint(const Render& render, const Layer& layer) {
  for (const ChannelInfo& channel : part_of(render, layer).channels)
    if (channel.name == layer.channels.front()) return channel.type == SampleType::Uint;
  return false;
}

/// Whether the layer is a depth for compositing next to another one in its view layer. Alone it is merged, as a
/// feature.
bool is_second_depth(const Render& first, const Layer& layer) {
  return layer.role == Role::Depth && is_compositing_depth(layer.pass) &&
         std::any_of(first.layers.begin(), first.layers.end(), [&](const Layer& other) {
           return other.role == Role::Depth && other.companion == Companion::Mean && other.rank < layer.rank &&
                  other.view_layer == layer.view_layer && other.view == layer.view;
         });
}

Fate fate_of(const Render& first, const Layer& layer) {
  const Values values = info_of(layer.role).values;
  if (layer.companion != Companion::Mean || values == Values::Count) return Fate::Dropped;
  if (values == Values::Exact || all_uint(first, layer) || is_second_depth(first, layer)) return Fate::Kept;
  return Fate::Merged;
}

/// Whether a render without the layer has another one with its role.
bool has_substitute(const Render& render, const Layer& layer) {
  for (std::size_t l = 0; l < render.layers.size(); ++l) {
    const Layer& other = render.layers[l];
    if (!render.absent[l] && other.role == layer.role && other.companion == layer.companion &&
        other.view_layer == layer.view_layer && other.view == layer.view)
      return true;
  }
  return false;
}

/// Checks that layers which some renders lack are in the first one alone, from which they are copied. Each render needs
/// the picture and one layer for each role in the fit.
void check_absent(const std::vector<Render>& renders) {
  const Render& first = renders.front();
  for (std::size_t l = 0; l < first.layers.size(); ++l) {
    const Layer& layer = first.layers[l];
    const auto lacks = [&](const Render& render) { return !render.absent.empty() && render.absent[l]; };
    const auto lacking = std::find_if(renders.begin(), renders.end(), lacks);
    if (lacking == renders.end()) continue;
    const bool first_alone = std::all_of(renders.begin() + 1, renders.end(), lacks);
    const bool needed = info_of(layer.role).in_fit && fate_of(first, layer) == Fate::Merged;
    if (!first_alone || (needed && !has_substitute(*lacking, layer)))
      misfit(*lacking, first, fmt::format("no layer {}", layer.name));
  }
}

/// The data windows of all parts together.
Rect window_of(const Render& render) {
  Rect window;
  for (const FileInfo& file : render.files)
    for (const PartInfo& part : file.parts)
      if (part.readable()) window = bounding(window, part.data_window);
  return window;
}

/// The first beauty that can be read.
const Layer& beauty_of(const Render& render) {
  std::string obstacle;
  for (const Layer& layer : render.layers) {
    if (layer.role != Role::Beauty || layer.companion != Companion::Mean) continue;
    if (part_of(render, layer).readable()) return layer;
    const FileInfo& file = file_of(render, layer);
    obstacle = fmt::format("{}is {}", file.parts.size() == 1 ? "" : fmt::format("({}) ", title_of(file, layer.part)),
                           part_of(render, layer).obstacle());
  }
  if (!obstacle.empty()) throw Error(ExitCode::BadInput, fmt::format("{}: the beauty {}", path_of(render), obstacle));
  throw Error(ExitCode::Missing, fmt::format("{}: no beauty to merge", path_of(render)));
}

void require_size(const std::vector<Render>& renders, std::size_t max_pixels) {
  Rect all;
  for (const Render& render : renders) all = bounding(all, render.window);
  const double width = static_cast<double>(all.x1) - all.x0, height = static_cast<double>(all.y1) - all.y0;
  if (width * height > static_cast<double>(max_pixels))
    throw Error(ExitCode::BadInput, fmt::format("{}: the renders together cover {:.0f} x {:.0f} pixels, more than the "
                                                "limit of {}; are they of one frame?",
                                                path_of(renders.front()), width, height, max_pixels));
}

/// Sets the windows and regions of the renders.
void place_renders(std::vector<Render>& renders, std::size_t max_pixels) {
  for (Render& render : renders) render.window = window_of(render);
  require_size(renders, max_pixels);
  std::vector<ShownPart> shown;
  for (const Render& render : renders) {
    const Layer& beauty = beauty_of(render);
    shown.push_back({render.window, &file_of(render, beauty), beauty.part, all_channels(beauty)});
  }
  const std::vector<Region> regions = find_regions(shown);
  for (std::size_t k = 0; k < renders.size(); ++k) renders[k].region = regions[k];
}

/// Files next to the named one may hold its picture in other forms. Returns the names of these layers.
std::set<std::string> leave_out_other_pictures(Render& render) {
  const auto is_other = [](const Layer& layer) {
    return layer.file > 0 && layer.role == Role::Beauty && layer.companion == Companion::Mean;
  };
  std::set<std::string> names;
  for (const Layer& layer : render.layers)
    if (is_other(layer)) names.insert(layer.name);
  render.layers.erase(std::remove_if(render.layers.begin(), render.layers.end(), is_other), render.layers.end());
  return names;
}

/// Leaves out passes in files next to a render that other renders do not have. Returns their names.
std::set<std::string> leave_out_lone_passes(std::vector<Render>& renders) {
  std::map<std::string, std::size_t> uses;
  for (const Render& render : renders)
    for (const Layer& layer : render.layers)
      if (layer.file > 0) ++uses[layer.name];
  std::set<std::string> lone;
  for (const auto& [name, count] : uses)
    if (count < renders.size()) lone.insert(name);
  for (Render& render : renders) {
    const auto is_lone = [&](const Layer& layer) { return layer.file > 0 && lone.count(layer.name) > 0; };
    render.layers.erase(std::remove_if(render.layers.begin(), render.layers.end(), is_lone), render.layers.end());
    if (lone.size() < uses.size()) continue;
    render.files.resize(1);  // whose picture has the pass of the file's name only where others are next to it
    render.layers = find_layers(render.files.front());
  }
  return lone;
}

/// Leaves out variances, halves and sample counts that some renders lack: those of the others describe a part of the
/// result only. Returns their names.
std::set<std::string> leave_out_lone_companions(std::vector<Render>& renders) {
  const auto describes_samples = [](const Layer& layer) {
    return layer.companion != Companion::Mean || info_of(layer.role).values == Values::Count;
  };
  std::map<std::string, std::size_t> uses;
  for (const Render& render : renders)
    for (const Layer& layer : render.layers)
      if (describes_samples(layer)) ++uses[layer.name];
  std::set<std::string> lone;
  for (const auto& [name, count] : uses)
    if (count < renders.size()) lone.insert(name);
  for (Render& render : renders)
    render.layers.erase(
        std::remove_if(render.layers.begin(), render.layers.end(),
                       [&](const Layer& layer) { return describes_samples(layer) && lone.count(layer.name) > 0; }),
        render.layers.end());
  return lone;
}

std::vector<Render> open_renders(const std::vector<std::string>& paths, const ReadLimits& limits,
                                 std::vector<std::string>& notes) {
  if (paths.size() < 2) throw Error(ExitCode::Usage, "merge needs at least two renders of the same frame");
  std::vector<Render> renders;
  std::set<std::string> other_pictures;
  std::vector<std::string> siblings;  // of all renders, whose layers are in the result's lists
  for (const std::string& path : paths) {
    Render render;
    FrameSource source = open_source(path, limits, siblings);
    render.files = std::move(source.files);
    render.layers = std::move(source.layers);
    other_pictures.merge(leave_out_other_pictures(render));
    if (is_result(render.files.front()))
      notes.push_back(fmt::format(
          "{} is a result of denoise: its error is not independent of its neighbours', which variance and halves do "
          "not show; merge the renders and denoise the merged file",
          path));
    if (render.files.front().format != "openexr")
      throw Error(ExitCode::BadInput, fmt::format("{}: merge needs OpenEXR files", path));
    std::error_code failure;
    for (const Render& other : renders)
      if (std::filesystem::equivalent(path, path_of(other), failure))
        throw Error(ExitCode::Usage, fmt::format("{}: given twice; renders have to be independent", path));
    renders.push_back(std::move(render));
  }
  for (const std::string& name : other_pictures)
    notes.push_back(
        fmt::format("{} is left out: it holds the picture in another form; merge those files for it", name));
  for (const std::string& name : leave_out_lone_passes(renders))
    notes.push_back(fmt::format("{} is left out: not every render has a file with it", name));
  for (const std::string& name : leave_out_lone_companions(renders))
    notes.push_back(fmt::format("{} is left out: not every render has it", name));
  for (std::size_t k = 1; k < renders.size(); ++k) check_fits(renders[k], renders.front());
  check_absent(renders);
  place_renders(renders, limits.max_pixels);
  return renders;
}

/// The name of a channel in the output, which has one part.
std::string output_name(const Render& first, const Layer& layer, const std::string& channel,
                        const std::string& companion = {}) {
  const bool one_file = first.files.size() == 1;
  if (one_file && first.files.front().parts.size() == 1 && companion.empty()) return channel;
  std::string name = layer.view_layer.empty() ? "" : layer.view_layer + ".";
  // A pass from a file's name has what separates it from the rest of that name in front.
  name += (one_file ? layer.pass : layer.pass.substr(layer.pass.find_first_not_of("_- "))) + companion;
  if (!layer.view.empty()) name += "." + layer.view;
  return name + "." + word_of(layer, channel);
}

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

/// A channel that is merged: the index of its layer, and its index in all_channels.
struct Slot {
  std::size_t layer, channel;
};

/// Copies what two rectangles of rows have in common within a third one. Elements are of `size` bytes.
void copy_common(const char* from, const Rect& source, char* to, const Rect& target, const Rect& within,
                 std::size_t size) {
  const Rect common = intersect(intersect(source, target), within);
  if (common.empty()) return;
  const auto offset = [&](const Rect& r, int y) {
    return (static_cast<std::size_t>(y - r.y0) * static_cast<std::size_t>(r.width()) +
            static_cast<std::size_t>(common.x0 - r.x0)) *
           size;
  };
  for (int y = common.y0; y < common.y1; ++y)
    std::memcpy(to + offset(target, y), from + offset(source, y), static_cast<std::size_t>(common.width()) * size);
}

/// Reads channels of a part over an area: a plane for each, 0 outside the part's data window.
std::vector<float> read_area(const FileInfo& file, int part, const std::vector<std::string>& channels,
                             const Rect& area) {
  const Rect& window = file.parts[static_cast<std::size_t>(part)].data_window;
  ChannelReader reader(file, part, channels);
  if (intersect(window, area) == area && window.width() == area.width()) return reader.read(area.y0, area.y1);
  std::vector<float> samples(area.area() * channels.size(), 0.0F);
  const Rect rows{window.x0, std::max(window.y0, area.y0), window.x1, std::min(window.y1, area.y1)};
  if (rows.empty()) return samples;
  const std::vector<float>& found = reader.read(rows.y0, rows.y1);
  for (std::size_t c = 0; c < channels.size(); ++c)
    copy_common(reinterpret_cast<const char*>(found.data() + c * rows.area()), rows,
                reinterpret_cast<char*>(samples.data() + c * area.area()), area, area, sizeof(float));
  return samples;
}

Rect area_of(const NativeBand& band) { return {band.x0, band.y0, band.x0 + band.width, band.y1}; }

/// The samples of a band of one render.
struct DecodedRender {
  std::vector<std::vector<float>> samples;  ///< By part.
  std::vector<const float*> planes;         ///< By slot.
};

/// Makes the merged file band by band.
class Merger {
 public:
  /// first_b: index of the first render of half B; those before it are half A. 0: as split_renders divides them.
  Merger(std::vector<Render> renders, const MergeOptions& options, std::size_t first_b)
      : renders_(std::move(renders)),
        samples_(options.samples),
        compress_(options.compress),
        overflows_(renders_.front().layers.size()) {
    choose_window();
    for (std::size_t l = 0; l < first().layers.size(); ++l) sort_layer(l);
    find_weights();
    choose_halves(first_b);
    report_.files = static_cast<int>(renders_.size());
  }

  Imf::Header header() const {
    const Imf::MultiPartInputFile input(path_of(first()).c_str(), 0, false);
    Imf::Header header(input.header(0).displayWindow(), {{window_.x0, window_.y0}, {window_.x1 - 1, window_.y1 - 1}});
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = compress_ ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
    header.zipCompressionLevel() = zip_level;
    copy_metadata(input, header);
    header.channels() = output_channels();
    if (const auto views = stereo_views(); !views.empty()) Imf::addMultiView(header, views);
    for (const auto& [view_layer, samples] : metadata_samples_) {
      for (const SamplesAttribute& copied : samples_attributes(view_layer))
        replace_number(header, copied.name, samples);
      header.insert(with_view_layer(samples_attribute, view_layer), Imf::FloatAttribute(static_cast<float>(samples)));
    }
    header.insert("polyrecon/version", Imf::StringAttribute(POLYRECON_VERSION));
    if (!shared_samples_.empty()) header.insert(shared_samples_attribute, Imf::StringAttribute(shared_samples_));
    return header;
  }

  void make(NativeBand& band) {
    const auto weights = read_weights(area_of(band));
    merge_layers(weights, band);
    for (const std::size_t l : kept_) copy_layer(l, band);
    for (const std::string& view_layer : counted_) write_counts(view_layer, weights, band);
  }

  /// Lines that are merged at once: as many as the sums of sums_at_once samples have, at least one chunk.
  int lines_per_band() const {
    const std::size_t line = std::max<std::size_t>(1, slots_.size() * static_cast<std::size_t>(window_.width()));
    return std::max(chunk_lines, static_cast<int>(std::min<std::size_t>(sums_at_once / line, band_lines)) /
                                     chunk_lines * chunk_lines);
  }

  /// Throws Error{OutOfMemory} if a band, its sums and the decoded chunks of the inputs need more than max_bytes.
  void require_memory(std::size_t max_bytes) const {
    const auto lines = static_cast<std::size_t>(std::min(window_.height(), lines_per_band()));
    std::size_t bytes =  // of one pixel
        slots_.size() * (sizeof(Accumulator) + 2 * sizeof(MeanAccumulator) + (4 + 2 * renders_at_once) * sizeof(float));
    for (const FileInfo& file : first().files)
      for (const PartInfo& part : file.parts) bytes += part.channels.size() * 3 * sizeof(float);
    if (static_cast<std::size_t>(window_.width()) * lines > max_bytes / std::max<std::size_t>(bytes, 1))
      throw Error(ExitCode::OutOfMemory, fmt::format("{}: {} lines of {} pixels need more than the limit of {} MB",
                                                     path_of(first()), lines, window_.width(), max_bytes >> 20));
  }

  MergeResult report() {
    if (left_out_ > 0)
      report_.notes.push_back(
          fmt::format("{} samples that are not finite were left out of the means", left_out_.load()));
    for (std::size_t l = 0; l < overflows_.size(); ++l)
      if (overflows_[l] > 0) report_.notes.push_back(overflow_note(first().layers[l].name, overflows_[l]));
    if (!merged_.empty() && !joins_ && !any_spread_)
      report_.notes.emplace_back("the renders are equal in every pixel: were they made with the same seed or offset?");
    const auto pixels = static_cast<double>(window_.area());
    report_.samples = counted_.empty() ? 0 : count_sum_ / pixels / static_cast<double>(counted_.size());
    return report_;
  }

 private:
  using Weights = std::vector<std::map<std::string, std::vector<double>>>;  ///< [render][view layer][pixel]

  const Render& first() const { return renders_.front(); }

  void choose_window() {
    std::map<std::size_t, std::size_t> regions_of_rank;
    std::vector<Rect> rects;
    for (const Render& render : renders_) {
      window_ = bounding(window_, render.window);
      ++regions_of_rank[render.region.rank];
      rects.push_back(render.region.rect);
    }
    has_regions_ = std::any_of(rects.begin(), rects.end(), [&](const Rect& r) { return !(r == window_); });
    const double single = share_of_single_cover(rects);
    const std::size_t groups = regions_of_rank[0], lone_groups = groups - regions_of_rank[1];
    joins_ = report_.joined = lone_groups > 0 || single > most_single_cover;
    if (groups > 1) report_.notes.push_back(fmt::format("{} regions are joined to one picture", groups));
    note_parts(groups);
    if (joins_ && lone_groups < groups)
      report_.notes.push_back(
          lone_groups > 0
              ? fmt::format("no variance or halves are written, as {} regions have one render only", lone_groups)
              : fmt::format("no variance or halves are written, as {:.0f} % of the picture has one render only",
                            100 * single));
  }

  /// Notes renders that have samples of a part of what the others of their group show.
  void note_parts(std::size_t groups) {
    std::map<std::size_t, Rect> whole;
    for (const Render& render : renders_) {
      Rect& rect = whole[render.region.group];
      rect = bounding(rect, render.region.rect);
    }
    const auto parts = std::count_if(renders_.begin(), renders_.end(), [&](const Render& render) {
      return !(render.region.rect == whole[render.region.group]);
    });
    if (parts > 0)
      report_.notes.push_back(fmt::format(
          "{} of {} renders show a part of {} only and have no samples beyond it, where the others show light", parts,
          renders_.size(), groups > 1 ? "their region" : "the picture"));
  }

  /// Whether some render has samples of the pixel.
  bool is_covered(int x, int y) const {
    return std::any_of(renders_.begin(), renders_.end(), [&](const Render& r) { return r.region.rect.contains(x, y); });
  }

  Fate fate(std::size_t l) const {
    const Layer& layer = first().layers[l];
    if (renders_[1].absent[l]) return Fate::Kept;
    // Where each region has one render, its variance and halves describe the picture.
    const bool joined = joins_ && layer.companion != Companion::Mean && info_of(layer.role).values != Values::Count;
    return joined ? Fate::Merged : fate_of(first(), layer);
  }

  void sort_layer(std::size_t l) {
    const Layer& layer = first().layers[l];
    const PartInfo& part = part_of(first(), layer);
    if (!part.readable()) {
      report_.dropped.push_back(layer.name);
      report_.notes.push_back(fmt::format("{} is left out: {} is {}", layer.name,
                                          title_of(file_of(first(), layer), layer.part), part.obstacle()));
      return;
    }
    switch (fate(l)) {
      case Fate::Merged:
        merged_.push_back(l);
        for (std::size_t c = 0; c < all_channels(layer).size(); ++c) slots_.push_back({l, c});
        report_.merged.push_back(layer.name);
        break;
      case Fate::Kept:
        kept_.push_back(l);
        report_.kept.push_back(layer.name);
        break;
      case Fate::Dropped:
        report_.dropped.push_back(layer.name);
        break;
    }
  }

  std::optional<double> samples_of(const Render& render, const std::string& view_layer) const {
    return samples_ > 0 ? samples_ : samples_in_metadata(render.files.front(), view_layer);
  }

  /// The sample-count layer of a view layer, -1 without one.
  int count_layer(const std::string& view_layer) const {
    int best = -1;
    for (std::size_t l = 0; l < first().layers.size(); ++l) {
      const Layer& layer = first().layers[l];
      if (renders_[1].absent[l]) continue;
      if (layer.role != Role::SampleCount || layer.view_layer != view_layer || !part_of(first(), layer).readable())
        continue;
      if (best < 0 || layer.rank < first().layers[static_cast<std::size_t>(best)].rank) best = static_cast<int>(l);
    }
    return best;
  }

  /// Whether the metadata hold the number of the whole sequence of which the renders are parts.
  bool metadata_count_sequence(const std::string& view_layer) const {
    const std::vector<SamplesAttribute> attributes = samples_attributes(view_layer);
    return std::any_of(attributes.begin(), attributes.end(), [&](const SamplesAttribute& attribute) {
      return attribute.of_sequence && find_attribute(first().files.front().parts.front(), attribute.name) != nullptr;
    });
  }

  void find_weights() {
    std::set<std::string> view_layers;
    for (const std::size_t l : merged_) view_layers.insert(first().layers[l].view_layer);
    for (const std::string& view_layer : view_layers) {
      const int layer = count_layer(view_layer);
      const bool fraction = layer >= 0 && is_sample_fraction(first().layers[static_cast<std::size_t>(layer)].pass);
      double total = 0;  // of the first render's region
      bool known = true;
      for (const Render& render : renders_) {
        const auto samples = samples_of(render, view_layer);
        known = known && samples.has_value();
        if (render.region.group == first().region.group) total += samples.value_or(0);
      }
      if (known) metadata_samples_[view_layer] = total;
      const FirstSamples first_samples = compare_first_samples(view_layer);
      if (known && samples_ <= 0 && metadata_count_sequence(view_layer) && first_samples != FirstSamples::Shared)
        report_.notes.push_back(
            fmt::format("{}: {:g} samples in all by the metadata; subsets of one sequence have fewer, give --samples",
                        view_layer, total));
      if (known && (layer < 0 || fraction)) note_shared_samples(view_layer, total, first_samples);
      if (known || (layer >= 0 && !fraction))
        counted_.push_back(view_layer);
      else if (!joins_)
        report_.notes.push_back(fmt::format("{}: sample counts are unknown, all renders count alike",
                                            view_layer.empty() ? "the image" : view_layer));
    }
  }

  /// first_b: as in the constructor.
  void choose_halves(std::size_t first_b) {
    half_b_.resize(renders_.size());
    halves_weigh_alike_ = first_b > 0 && !joins_;
    if (joins_) {
      if (first_b > 0) report_.notes.emplace_back("--half-b has no effect: no halves are written");
      return;
    }
    if (halves_weigh_alike_) {
      std::fill(half_b_.begin() + static_cast<std::ptrdiff_t>(first_b), half_b_.end(), true);
      return;
    }
    for (const Render& region : renders_) {
      if (region.region.rank > 0) continue;
      std::vector<std::size_t> indices;
      for (std::size_t k = 0; k < renders_.size(); ++k)
        if (renders_[k].region.group == region.region.group) indices.push_back(k);
      const std::vector<double> samples = mean_samples(indices);
      const std::vector<bool> half_b = split_renders(samples);
      std::array<double, 2> sums{};
      for (std::size_t i = 0; i < indices.size(); ++i) {
        half_b_[indices[i]] = half_b[i];
        sums[half_b[i] ? 1 : 0] += samples[i];
      }
      note_uneven_halves(sums);
    }
  }

  void note_uneven_halves(const std::array<double, 2>& samples) {
    constexpr double uneven = 2;
    if (counted_.empty() || std::max(samples[0], samples[1]) <= uneven * std::min(samples[0], samples[1])) return;
    report_.notes.push_back(fmt::format(
        "the halves have {:.3g} and {:.3g} samples per pixel, so the estimated error will be too high; merge "
        "renders of similar length",
        samples[0], samples[1]));
  }

  /// Mean samples per pixel of some renders, from a few lines of their sample-count pass; all the same if unknown.
  std::vector<double> mean_samples(const std::vector<std::size_t>& renders) const {
    std::vector<double> means(renders.size(), 1);
    if (counted_.empty() || renders.size() < 2) return means;
    in_parallel(renders.size(), [&](std::size_t i) {
      const Render& render = renders_[renders[i]];
      constexpr int lines = 5;
      double sum = 0;
      for (int line = 0; line < lines; ++line) {
        Rect area = render.region.rect;
        area.y0 += (2 * line + 1) * area.height() / (2 * lines);
        area.y1 = area.y0 + 1;
        for (const double n : read_counts(render, counted_.front(), area)) sum += n;
      }
      means[i] = sum / (lines * static_cast<double>(render.region.rect.width()));
    });
    return means;
  }

  enum class FirstSamples { Shared, Apart, Unknown };

  /// Whether the first two renders both have the first sample of a sequence: by the depth of that sample, in the lines
  /// in the middle of the picture. A render of later samples of the sequence has sky there.
  FirstSamples compare_first_samples(const std::string& view_layer) const {
    for (std::size_t l = 0; l < first().layers.size(); ++l) {
      const Layer& layer = first().layers[l];
      if (!is_compositing_depth(layer.pass) || layer.view_layer != view_layer || renders_[1].absent[l]) continue;
      const bool a = hits_something(renders_[0], l), b = hits_something(renders_[1], l);
      if (a || b) return a && b ? FirstSamples::Shared : FirstSamples::Apart;
    }
    return FirstSamples::Unknown;
  }

  static bool hits_something(const Render& render, std::size_t l) {
    const Layer& layer = render.layers[l];
    if (!part_of(render, layer).readable()) return false;
    const Rect& window = part_of(render, layer).data_window;
    const int y0 = std::max(window.y0, (window.y0 + window.y1 - chunk_lines) / 2);
    ChannelReader reader(file_of(render, layer), layer.part, layer.channels);
    const std::vector<float>& depth = reader.read(y0, std::min(window.y1, y0 + chunk_lines));
    return std::any_of(depth.begin(), depth.end(), [](float z) { return z < sky_depth(); });
  }

  /// Notes that the errors of short renders with different seeds are not independent where their first sample has the
  /// same place. samples: of all renders.
  void note_shared_samples(const std::string& view_layer, double samples, FirstSamples first_samples) {
    const auto others = static_cast<double>(renders_.size() - 1);
    const double each = samples / static_cast<double>(renders_.size());
    const FileInfo& file = first().files.front();
    const std::vector<std::string> names = attributes_of_central_samples(view_layer);
    const bool central = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return find_attribute(file.parts.front(), name) != nullptr;
    });
    const bool subsets = samples_ > 0 && samples_ < samples_in_metadata(file, view_layer).value_or(0);
    if (!central || subsets || has_regions_ || each > longest_shared * others) return;
    if (first_samples == FirstSamples::Apart) return;
    shared_samples_ = fmt::format(
        "{}: {}the first of the {:g} samples of each of the {} renders lies at the pixel's centre, so their "
        "errors are alike at edges and textures, where the variance is too low; fewer and longer renders "
        "have less error, subsets of one sequence the least",
        view_layer, first_samples == FirstSamples::Shared ? "" : "if the renders differ in their seed, ", each,
        renders_.size());
    report_.notes.push_back(shared_samples_);
  }

  /// The sample counts n_k of every pixel of a band; where they are unknown, the weights of regions.
  Weights read_weights(const Rect& area) {
    Weights weights(renders_.size());
    in_parallel(renders_.size(), [&](std::size_t k) {
      for (const std::string& view_layer : counted_)
        weights[k][view_layer] = read_counts(renders_[k], view_layer, area);
      if (!has_regions_) return;
      for (const std::size_t l : merged_)
        weights[k].try_emplace(first().layers[l].view_layer, std::vector<double>(area.area(), 1.0));
      for (auto& [view_layer, n] : weights[k]) leave_region(renders_[k], area, n);
    });
    return weights;
  }

  std::vector<double> read_counts(const Render& render, const std::string& view_layer, const Rect& area) const {
    const int l = count_layer(view_layer);
    const double metadata = samples_of(render, view_layer).value_or(0);
    std::vector<double> n(area.area(), metadata);
    if (l < 0) return n;
    const Layer& layer = render.layers[static_cast<std::size_t>(l)];
    const double scale = is_sample_fraction(layer.pass) ? metadata : 1;
    const std::vector<float> counts = read_area(file_of(render, layer), layer.part, layer.channels, area);
    for (std::size_t i = 0; i < n.size(); ++i) n[i] = std::isfinite(counts[i]) && counts[i] > 0 ? counts[i] * scale : 0;
    return n;
  }

  /// A render has no samples beyond its region.
  static void leave_region(const Render& render, const Rect& area, std::vector<double>& n) {
    std::size_t i = 0;
    for (int y = area.y0; y < area.y1; ++y)
      for (int x = area.x0; x < area.x1; ++x, ++i)
        if (!render.region.rect.contains(x, y)) n[i] = 0;
  }

  /// Decodes the merged channels of one render, each part once.
  DecodedRender decode(std::size_t k, const NativeBand& band) {
    const Render& render = renders_[k];
    const std::size_t pixels = static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.y1 - band.y0);
    DecodedRender decoded;
    decoded.planes.resize(slots_.size());
    std::set<std::pair<int, int>> parts;  // file and part
    for (const Slot& slot : slots_) parts.insert({render.layers[slot.layer].file, render.layers[slot.layer].part});
    for (const auto& [file, part] : parts) {
      std::vector<std::string> channels;
      std::vector<std::size_t> slots;
      for (std::size_t s = 0; s < slots_.size(); ++s) {
        const Layer& layer = render.layers[slots_[s].layer];
        if (layer.file != file || layer.part != part) continue;
        channels.push_back(all_channels(layer)[slots_[s].channel]);
        slots.push_back(s);
      }
      decoded.samples.push_back(read_area(render.files[static_cast<std::size_t>(file)], part, channels, area_of(band)));
      for (std::size_t c = 0; c < slots.size(); ++c) {
        const std::size_t l = slots_[slots[c]].layer;
        const Layer& layer = render.layers[l];
        float* plane = decoded.samples.back().data() + c * pixels;
        overflows_[l] +=
            bring_into_range(beyond_range(part_of(render, layer), layer, layer.role, channels[c]), plane, pixels);
        decoded.planes[slots[c]] = plane;
      }
    }
    return decoded;
  }

  /// Adds the renders with indices from first to end - 1 to the sums. Each sum is in the order of the renders.
  void add_renders(std::size_t first, std::size_t end, const Weights& weights, const NativeBand& band,
                   std::vector<ChannelSums>& sums) {
    std::vector<DecodedRender> decoded(end - first);
    in_parallel(decoded.size(), [&](std::size_t i) { decoded[i] = decode(first + i, band); });
    const std::size_t pixels = sums.front().all.size();
    const std::size_t blocks = (pixels + pixels_at_once - 1) / pixels_at_once;
    in_parallel(slots_.size() * blocks, [&](std::size_t task) {
      const std::size_t slot = task / blocks, begin = task % blocks * pixels_at_once;
      const std::string& view_layer = renders_.front().layers[slots_[slot].layer].view_layer;
      for (std::size_t k = first; k < end; ++k) {
        const auto known = weights[k].find(view_layer);
        const double* n = known == weights[k].end() ? nullptr : known->second.data();
        const float* samples = decoded[k - first].planes[slot];
        for (std::size_t i = begin; i < std::min(begin + pixels_at_once, pixels); ++i)
          add(sums[slot], i, samples[i], n ? n[i] : 1, k);
      }
    });
  }

  void merge_layers(const Weights& weights, NativeBand& band) {
    if (slots_.empty()) return;
    const std::size_t pixels = static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.y1 - band.y0);
    std::vector<ChannelSums> sums(slots_.size(), ChannelSums(pixels));
    for (std::size_t k = 0; k < renders_.size(); k += renders_at_once)
      add_renders(k, std::min(k + renders_at_once, renders_.size()), weights, band, sums);
    in_parallel(slots_.size(), [&](std::size_t s) {
      const Layer& layer = first().layers[slots_[s].layer];
      if (slots_[s].channel < layer.channels.size())
        write_channel(layer, layer.channels[slots_[s].channel], sums[s], band);
      else
        write_mean(*band.find(output_name(first(), layer, layer.alpha)), sums[s], band);
    });
  }

  void add(ChannelSums& sums, std::size_t i, float x, double weight, std::size_t k) {
    if (weight <= 0) return;
    if (!std::isfinite(x)) {
      ++left_out_;
      return;
    }
    sums.all[i].add(x, weight);
    (half_b_[k] ? sums.half_b : sums.half_a)[i].add(x, weight);
  }

  static void put(NativeChannel& channel, std::size_t i, double value) {
    const auto narrow = static_cast<float>(value);
    std::memcpy(channel.samples.data() + i * sizeof narrow, &narrow, sizeof narrow);
  }

  struct Moments {
    double mean;
    double variance;  ///< Variance of that mean.
  };

  /// The weighted mean over all renders, or with options.half_b the plain mean of the halves. Between regions, where
  /// nothing was rendered, it is 0.
  Moments moments(const ChannelSums& sums, std::size_t i, const NativeBand& band) const {
    const Accumulator& all = sums.all[i];
    const MeanAccumulator &a = sums.half_a[i], &b = sums.half_b[i];
    const auto width = static_cast<std::size_t>(band.width);
    if (all.renders == 0 && has_regions_ &&
        !is_covered(band.x0 + static_cast<int>(i % width), band.y0 + static_cast<int>(i / width)))
      return {0, 0};
    if (all.renders == 0) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    if (!halves_weigh_alike_ || a.renders == 0 || b.renders == 0) return {all.mean, all.variance_of_mean()};
    const double of_a_sample = all.variance_of_mean() * all.weight;
    return {(a.mean + b.mean) / 2, of_a_sample * (1 / a.weight + 1 / b.weight) / 4};
  }

  void write_mean(NativeChannel& channel, const ChannelSums& sums, const NativeBand& band) const {
    for (std::size_t i = 0; i < sums.all.size(); ++i) put(channel, i, moments(sums, i, band).mean);
  }

  void write_channel(const Layer& layer, const std::string& name, const ChannelSums& sums, NativeBand& band) {
    NativeChannel& mean = *band.find(output_name(first(), layer, name));
    if (joins_) return write_mean(mean, sums, band);
    NativeChannel& variance = *band.find(output_name(first(), layer, name, variance_suffix));
    NativeChannel& half_a = *band.find(output_name(first(), layer, name, half_a_suffix));
    NativeChannel& half_b = *band.find(output_name(first(), layer, name, half_b_suffix));
    bool spread = false;
    for (std::size_t i = 0; i < sums.all.size(); ++i) {
      const Moments whole = moments(sums, i, band);
      spread = spread || sums.all[i].spreads();
      put(mean, i, whole.mean);
      put(variance, i, whole.variance);
      put(half_a, i, sums.half_a[i].renders > 0 ? sums.half_a[i].mean : whole.mean);
      put(half_b, i, sums.half_b[i].renders > 0 ? sums.half_b[i].mean : whole.mean);
    }
    if (spread) any_spread_ = true;
  }

  /// Copies the channels of a layer with their bits, whatever their type, from the first render that shows a pixel.
  void copy_layer(std::size_t l, NativeBand& band) {
    const Layer& layer = first().layers[l];
    for (const std::string& name : all_channels(layer)) {
      NativeChannel& to = *band.find(output_name(first(), layer, name));
      std::fill(to.samples.begin(), to.samples.end(), 0);
    }
    for (std::size_t k = renders_.size(); k-- > 0;)
      if ((renders_[k].absent.empty() || !renders_[k].absent[l]) && !is_behind(k)) copy_layer(renders_[k], l, band);
  }

  /// Whether all that a render shows is shown by the first one of its group.
  bool is_behind(std::size_t k) const {
    const Region& region = renders_[k].region;
    return region.rank > 0 && intersect(renders_[region.group].region.rect, region.rect) == region.rect;
  }

  void copy_layer(const Render& render, std::size_t l, NativeBand& band) {
    const Layer &layer = render.layers[l], &output = first().layers[l];
    const Rect area = area_of(band);
    const std::vector<std::string> channels = all_channels(layer), names = all_channels(output);
    const Rect& window = part_of(render, layer).data_window;
    const Rect rows{window.x0, std::max(window.y0, band.y0), window.x1, std::min(window.y1, band.y1)};
    if (rows.empty()) return;
    Imf::MultiPartInputFile container(file_of(render, layer).path.c_str(), 0, false);
    Imf::InputPart input(container, layer.part);
    NativeBand old(input.header());
    old.channels.erase(std::remove_if(old.channels.begin(), old.channels.end(),
                                      [&](const NativeChannel& c) {
                                        return std::find(channels.begin(), channels.end(), c.name) == channels.end();
                                      }),
                       old.channels.end());
    old.take_lines(rows.y0, rows.y1);
    read_band(input, old);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const NativeChannel& from = *old.find(channels[c]);
      NativeChannel& to = *band.find(output_name(first(), output, names[c]));
      if (from.type != to.type) misfit(render, first(), fmt::format("another type in layer {}", output.name));
      copy_common(from.samples.data(), rows, to.samples.data(), area, render.region.rect, size_of(to.type));
    }
  }

  void write_counts(const std::string& view_layer, const Weights& weights, NativeBand& band) {
    NativeChannel& channel = *band.find(count_name(view_layer));
    const std::size_t pixels = channel.samples.size() / sizeof(float);
    for (std::size_t i = 0; i < pixels; ++i) {
      double sum = 0;
      for (const auto& render : weights) sum += render.at(view_layer)[i];
      put(channel, i, sum);
      count_sum_ += sum;
    }
  }

  static std::string count_name(const std::string& view_layer) {
    return (view_layer.empty() ? "" : view_layer + ".") + sample_count_pass + ".X";
  }

  Imf::ChannelList output_channels() const {
    static constexpr std::array companions{"", variance_suffix, half_a_suffix, half_b_suffix};
    Imf::ChannelList list;
    for (const std::size_t l : merged_) {
      const Layer& layer = first().layers[l];
      for (const std::string& name : layer.channels)
        for (const char* companion : companions)
          if (!joins_ || *companion == 0)
            list.insert(output_name(first(), layer, name, companion), Imf::Channel(Imf::FLOAT));
      if (!layer.alpha.empty()) list.insert(output_name(first(), layer, layer.alpha), Imf::Channel(Imf::FLOAT));
    }
    for (const std::size_t l : kept_) {
      const Layer& layer = first().layers[l];
      for (const ChannelInfo& channel : part_of(first(), layer).channels) {
        const auto mine = all_channels(layer);
        if (std::find(mine.begin(), mine.end(), channel.name) == mine.end()) continue;
        const auto type = channel.type == SampleType::Half   ? Imf::HALF
                          : channel.type == SampleType::Uint ? Imf::UINT
                                                             : Imf::FLOAT;
        list.insert(output_name(first(), layer, channel.name), Imf::Channel(type));
      }
    }
    for (const std::string& view_layer : counted_) list.insert(count_name(view_layer), Imf::Channel(Imf::FLOAT));
    return list;
  }

  Imf::StringVector stereo_views() const {
    Imf::StringVector views;
    for (const Layer& layer : first().layers)
      if (!layer.view.empty() && std::find(views.begin(), views.end(), layer.view) == views.end())
        views.push_back(layer.view);
    return views;
  }

  std::vector<Render> renders_;
  double samples_;  ///< Samples of each render; 0: as the files say.
  bool compress_;
  bool halves_weigh_alike_ = false;  ///< The halves were given.
  std::vector<bool> half_b_;         ///< For each render whether it is of half B.
  Rect window_;                      ///< Of the result: all regions.
  bool has_regions_ = false;         ///< Some renders have samples of a part of the frame only.
  bool joins_ = false;               ///< Too much of the picture has one render only: no variance or halves are made.
  std::vector<std::size_t> merged_, kept_;  ///< Indices of layers.
  std::vector<Slot> slots_;                 ///< The channels of all merged layers.
  std::vector<std::string> counted_;        ///< View layers whose sample counts are known.
  std::map<std::string, double> metadata_samples_;
  std::string shared_samples_;  ///< The note on samples that the renders have in common; empty without one.
  MergeResult report_;
  std::atomic<std::size_t> left_out_ = 0;
  std::vector<std::atomic<std::size_t>> overflows_;  ///< Half samples of +Inf, by layer.
  double count_sum_ = 0;
  std::atomic<bool> any_spread_ = false;
};

}  // namespace

MergeResult merge(const std::vector<std::string>& paths, const std::string& target, const MergeOptions& options) {
  std::vector<std::string> all = paths;
  all.insert(all.end(), options.half_b.begin(), options.half_b.end());
  std::vector<std::string> notes;
  std::vector<Render> renders = open_renders(all, options.limits, notes);
  Merger merger(std::move(renders), options, options.half_b.empty() ? 0 : paths.size());
  merger.require_memory(options.limits.max_bytes);
  write_single_part(
      target, merger.header(), [&](NativeBand& band) { merger.make(band); }, merger.lines_per_band());
  MergeResult result = merger.report();
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
  return result;
}

}  // namespace polyrecon
