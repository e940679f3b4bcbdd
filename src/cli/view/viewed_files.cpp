#include "cli/view/viewed_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "cli/common/layers.h"
#include "core/nearest.h"
#include "core/resample.h"
#include "io/pictures/color.h"
#include "io/values/pass_values.h"
#include "polyrecon/error.h"
#include "polyrecon/frame.h"

namespace polyrecon {
namespace {

/// Decoded bytes of layers that are read at once: each chunk of a file holds all its channels, so reading layer by
/// layer would decode it again for each.
constexpr std::size_t batch_bytes = std::size_t{256} << 20;

/// In the order in which layers are put into the page.
enum class Importance { First, Maps, Rest };

struct Wanted {
  const Layer* layer = nullptr;
  Importance importance = Importance::Rest;
  bool is_picture = false;  ///< The file's main picture.
};

bool readable(const LayeredFile& file, const Layer& layer) {
  return file.info.parts[static_cast<std::size_t>(layer.part)].readable() && !layer.channels.empty();
}

/// Three channels of anything but a variance or an error look like a picture.
bool is_map(const LayeredFile& file, const Layer& layer) {
  return is_error_map(file) || is_variance(layer.companion) || (!is_color(layer) && layer.channels.size() != 3);
}

/// A file's layers with the alpha channels, which layers hold apart: data such as the coverage of Cryptomatte stay with
/// their layer, the alpha of a picture is a layer of its own.
LayeredFile with_alphas(LayeredFile file) {
  std::vector<Layer> alphas;
  const Layer* picture = color_layer(file);
  for (Layer& layer : file.layers) {
    if (layer.alpha.empty() || layer.companion != Companion::Mean) continue;
    if (!is_color(layer)) layer.channels.push_back(layer.alpha);
    if (&layer != picture) continue;
    Layer alpha = layer;
    alpha.name = "alpha of " + layer.name;
    alpha.channels = {layer.alpha};
    alpha.role = Role::Alpha;
    alphas.push_back(std::move(alpha));
  }
  file.layers.insert(file.layers.end(), alphas.begin(), alphas.end());
  return file;
}

/// The wanted layers of a file, the one that is shown first at the beginning.
std::vector<Wanted> wanted_layers(const LayeredFile& file, const std::vector<std::string>& names) {
  std::vector<Wanted> found;
  const Layer* picture = color_layer(file);
  if (names.empty()) {
    const Layer& main = main_layer(file);
    if (!readable(file, main))
      throw Error(ExitCode::BadInput, fmt::format("{}: layer '{}': {}", file.info.path, main.name,
                                                  file.info.parts[static_cast<std::size_t>(main.part)].obstacle()));
    found.push_back({&main, Importance::First, &main == picture});
    for (const Layer& layer : file.layers)
      if (&layer != &main && readable(file, layer))
        found.push_back({&layer, is_map(file, layer) ? Importance::Maps : Importance::Rest, false});
    return found;
  }
  for (const std::string& name : names)
    if (const Layer* layer = find_layer(file, name); layer && readable(file, *layer))
      found.push_back({layer, Importance::First, layer == picture});
  if (found.empty()) {
    std::vector<std::string> known;
    for (const Layer& layer : file.layers) known.insert(known.end(), {layer.name, layer.pass});
    throw Error(ExitCode::Missing,
                fmt::format("{}: has none of the layers '{}'{} (polyrecon inspect lists its layers)", file.info.path,
                            fmt::join(names, "', '"), did_you_mean(names.front(), known)));
  }
  return found;
}

/// An image and the place of its upper left pixel.
struct Placed {
  Image image;
  int x = 0, y = 0;
};

int rounded_down(int value, int step) { return (value >= 0 ? value : value - step + 1) / step; }

/// The selected part of an image that begins at (x, y); empty where nothing is left. Blocks of pixels that become one
/// begin at multiples of the scale in the file's coordinates, so that they are the same ones in all files.
Placed selected(const Image& image, int x, int y, const ViewSelection& selection) {
  Rect part{x, y, x + image.width(), y + image.height()};
  if (selection.region)
    part = {std::max(part.x0, selection.region->x0), std::max(part.y0, selection.region->y0),
            std::min(part.x1, selection.region->x1), std::min(part.y1, selection.region->y1)};
  const int step = selection.scale;
  const auto first_whole = [&](int begin) { return -rounded_down(-begin, step) * step; };
  part.x0 = first_whole(part.x0);
  part.y0 = first_whole(part.y0);
  if (part.empty()) return {};
  const Rect inside{part.x0 - x, part.y0 - y, part.x1 - x, part.y1 - y};
  return {reduced(crop(image, inside), step), part.x0 / step, part.y0 / step};
}

/// The scale of values with a sign, zero in its middle. The largest ones do not count, as in log_range.
MapScale signed_scale(const Image& values) {
  Image magnitudes(values.width(), values.height() * values.channels(), 1);
  for (std::size_t i = 0; i < magnitudes.pixels(); ++i)
    magnitudes.plane(0)[i] = std::abs(values.plane(static_cast<int>(i / values.pixels()))[i % values.pixels()]);
  const double high = log_range(magnitudes).high;
  return {-high, high, false};
}

bool has_negatives(const Image& values) {
  for (int c = 0; c < values.channels(); ++c)
    if (std::any_of(values.plane(c), values.plane(c) + values.pixels(),
                    [](Real v) { return std::isfinite(v) && v < 0; }))
      return true;
  return false;
}

/// A scale for a layer in false colours that holds for what the layer is, not for the values of one file.
std::optional<MapScale> scale_of(const Layer& layer, const Image& values) {
  if (layer.name == "order") return MapScale{-1, 2, false};
  if (layer.name == "priorshare") return MapScale{0, 1, false};
  if (layer.role != Role::Depth && has_negatives(values)) return signed_scale(values);
  Image magnitudes(values.width(), values.height(), 1);
  for (std::size_t i = 0; i < values.pixels(); ++i) {
    double sum = 0;
    for (int c = 0; c < values.channels(); ++c) sum += static_cast<double>(values.plane(c)[i]) / values.channels();
    // The distance of the sky would push all others to one end of the scale.
    if (layer.role != Role::Depth || sum < Frame().sky_depth) magnitudes.plane(0)[i] = static_cast<Real>(sum);
  }
  const LogRange range = log_range(magnitudes);
  if (!(range.high > 0)) return std::nullopt;
  if (info_of(layer.role).values == Values::Count || layer.role == Role::Alpha) return MapScale{0, range.high, false};
  return MapScale{range.high > range.low ? range.low : range.high / 10, range.high, true};
}

/// Whether values of a layer of whole numbers are too large for floats, as identifiers often are.
bool are_rounded(const PartInfo& part, const std::vector<std::string>& channels, const Image& values) {
  constexpr Real largest_exact = 16777216;  // 2^24
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const Real* const plane = values.plane(static_cast<int>(c));
    const bool whole = std::any_of(part.channels.begin(), part.channels.end(), [&](const ChannelInfo& channel) {
      return channel.name == channels[c] && channel.type == SampleType::Uint;
    });
    if (whole && std::any_of(plane, plane + values.pixels(), [](Real v) { return v >= largest_exact; })) return true;
  }
  return false;
}

bool are_halves(const PartInfo& part, const std::vector<std::string>& channels) {
  return std::all_of(channels.begin(), channels.end(), [&](const std::string& name) {
    return std::any_of(part.channels.begin(), part.channels.end(), [&](const ChannelInfo& channel) {
      return channel.name == name && channel.type == SampleType::Half;
    });
  });
}

/// The name of a layer for people. The layers of our maps have short names, which are explained.
std::string label_of(const LayeredFile& file, const Layer& layer) {
  static const std::map<std::string, const char*> explained{{"mse", "estimated squared error"},
                                                            {"relmse", "estimated relative error"},
                                                            {"relvariance", "its part that is variance"},
                                                            {"relnoise", "relative noise of the input"},
                                                            {"priorshare", "share of the prior"}};
  if (layer.name.empty()) return "RGB";
  const auto at = is_error_map(file) ? explained.find(layer.name) : explained.end();
  return at == explained.end() ? layer.name : fmt::format("{}: {}", layer.name, at->second);
}

/// How a layer of a file is shown.
ViewedLayer viewed_layer(const LayeredFile& file, const Wanted& wanted, const Placed& placed) {
  const Layer& layer = *wanted.layer;
  ViewedLayer viewed{wanted.is_picture ? "" : layer.name,
                     label_of(file, layer),
                     layer.channels,
                     placed.x,
                     placed.y,
                     is_map(file, layer)};
  if (!wanted.is_picture && viewed.slot.empty()) viewed.slot = "RGB";
  if (viewed.is_map) viewed.scale = scale_of(layer, placed.image);
  if (viewed.scale && viewed.scale->low == -viewed.scale->high) viewed.colors = MapColors::Signed;
  // These tell most about a pixel of the picture: its noise, its samples, and the maps of a file that has no picture.
  const Layer* picture = color_layer(file);
  viewed.listed =
      !picture || layer.role == Role::SampleCount || (is_variance(layer.companion) && layer.of == picture->name);
  viewed.is_variance = layer.companion == Companion::VarianceOfMean;
  return viewed;
}

/// Adds layers of one file, in the order given, those of one part together.
class FileReader {
 public:
  FileReader(ViewerPage& page, const ViewedFile& viewed, const LayeredFile& file, const ViewSelection& selection)
      : page_(page), viewed_(viewed), file_(file), selection_(selection) {}

  /// Returns how many did not fit into the page.
  std::size_t add(const std::vector<Wanted>& layers) {
    std::size_t left_out = 0;
    for (std::size_t begin = 0; begin < layers.size();) {
      std::vector<std::string> channels;
      std::size_t end = begin;
      const int part = layers[begin].layer->part;
      const Rect window = file_.info.parts[static_cast<std::size_t>(part)].data_window;
      while (end < layers.size() && layers[end].layer->part == part &&
             (end == begin ||
              (channels.size() + layers[end].layer->channels.size()) * window.area() * sizeof(Real) <= batch_bytes)) {
        channels.insert(channels.end(), layers[end].layer->channels.begin(), layers[end].layer->channels.end());
        ++end;
      }
      left_out += add_batch(
          {layers.begin() + static_cast<std::ptrdiff_t>(begin), layers.begin() + static_cast<std::ptrdiff_t>(end)},
          read_channels(file_.info, part, channels), window);
      begin = end;
    }
    return left_out;
  }

  /// Layers whose values the page cannot hold exactly.
  const std::vector<std::string>& rounded() const { return rounded_; }

 private:
  ViewerPage& page_;
  const ViewedFile& viewed_;
  const LayeredFile& file_;
  const ViewSelection& selection_;
  std::vector<std::string> rounded_;

  std::size_t add_batch(const std::vector<Wanted>& layers, const Image& values, const Rect& window) {
    int first = 0;
    std::size_t left_out = 0;
    for (const Wanted& wanted : layers) {
      const int count = static_cast<int>(wanted.layer->channels.size());
      Image image = crop(values, values.bounds(), first, count);
      first += count;
      const bool in_xyz = is_picture_in_xyz(*wanted.layer);
      if (in_xyz) xyz_to_rgb_values(image);
      const Placed placed = selected(image, window.x0, window.y0, selection_);
      if (placed.image.empty()) {
        if (wanted.importance == Importance::First)
          throw Error(
              ExitCode::Usage,
              fmt::format("{}: layer '{}' covers {}..{}, {}..{}: nothing of it lies in --region", file_.info.path,
                          wanted.layer->name, window.x0, window.x1 - 1, window.y0, window.y1 - 1));
        continue;
      }
      const PartInfo& part = file_.info.parts[static_cast<std::size_t>(wanted.layer->part)];
      if (are_rounded(part, wanted.layer->channels, placed.image)) rounded_.push_back(wanted.layer->name);
      const bool halves = !in_xyz && selection_.scale == 1 && are_halves(part, wanted.layer->channels);
      if (!page_.add_layer(viewed_.image, viewed_.frames, viewed_layer(file_, wanted, placed), placed.image, halves))
        ++left_out;
    }
    return left_out;
  }
};

}  // namespace

std::vector<std::string> add_files(ViewerPage& page, const std::vector<ViewedFile>& files,
                                   const ViewSelection& selection) {
  std::vector<std::string> notes;
  std::map<std::string, std::size_t> left_out;
  for (const Importance importance : {Importance::First, Importance::Maps, Importance::Rest}) {
    if (importance != Importance::First && selection.first_only) break;
    for (const ViewedFile& viewed : files) {
      const LayeredFile file = with_alphas(open_layers(viewed.path));
      std::vector<Wanted> layers;
      for (const Wanted& wanted : wanted_layers(file, selection.layers))
        if (wanted.importance == importance) layers.push_back(wanted);
      if (layers.empty()) continue;
      FileReader reader(page, viewed, file, selection);
      const std::size_t missing = reader.add(layers);
      for (const std::string& name : reader.rounded())
        notes.push_back(fmt::format("{}: {}: whole numbers above 16777216 are rounded to floats", viewed.path, name));
      if (missing == 0) continue;
      if (importance == Importance::First)
        throw Error(
            ExitCode::Usage,
            fmt::format("{}: the page would have more than {} MB: choose a part by --region, smaller pictures by "
                        "--scale 2, fewer files, or another --max-size",
                        viewed.path, selection.max_bytes >> 20));
      left_out[viewed.path] += missing;
    }
  }
  for (const auto& [path, count] : left_out)
    notes.push_back(
        fmt::format("{}: {} layers were left out, as the page would have more than {} MB; --layer NAME, "
                    "--region, --scale or --max-size choose others",
                    path, count, selection.max_bytes >> 20));
  return notes;
}

}  // namespace polyrecon
