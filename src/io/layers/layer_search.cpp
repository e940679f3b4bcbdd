#include "io/layers/layer_search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "core/nearest.h"
#include "io/files/file.h"
#include "io/layers/channel_names.h"
#include "io/layers/choose_picture.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Adds a layer of this channel alone. nowhere: the file has no such channel.
int add_channel(FrameSource& source, const std::string& name) {
  auto& layers = source.layers;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    Layer alone = layers[l];
    const bool is_alpha = alone.alpha == name;
    if (!is_alpha && std::find(alone.channels.begin(), alone.channels.end(), name) == alone.channels.end()) continue;
    alone.name = name;
    alone.channels = {name};
    alone.alpha.clear();
    alone.companion = Companion::Mean;
    layers.push_back(alone);
    return static_cast<int>(layers.size()) - 1;
  }
  return nowhere;
}

/// The index of the first layer that fits; nowhere without one.
template <class Fits>
int index_of_layer(const FrameSource& source, const Fits& fits) {
  const auto found = std::find_if(source.layers.begin(), source.layers.end(), fits);
  return found == source.layers.end() ? nowhere : static_cast<int>(found - source.layers.begin());
}

}  // namespace

const PartInfo& part_of(const FrameSource& source, const Layer& layer) {
  return source.files[static_cast<std::size_t>(layer.file)].parts[static_cast<std::size_t>(layer.part)];
}

std::string in_part(const FrameSource& source, const Layer& layer) {
  const FileInfo& file = source.files[static_cast<std::size_t>(layer.file)];
  return file.parts.size() == 1 ? std::string() : fmt::format(" ({})", title_of(file, layer.part));
}

bool covers(const Rect& outer, const Rect& inner) { return intersect(outer, inner) == inner; }

std::string misfit(const PartInfo& part, const PartInfo& beauty) {
  if (!(part.display_window == beauty.display_window) && !covers(part.data_window, beauty.data_window))
    return "its display window is not the beauty's, nor does its data window contain the beauty's";
  if (intersect(part.data_window, beauty.data_window).empty()) return "its data window lies outside the beauty's";
  return {};
}

bool is_shaped(Role role, const Layer& layer) { return info_of(role).layer_channels.allow(layer.channels.size()); }

int find_layer(FrameSource& source, const std::string& name) {
  const LayerView here = place_of(source);
  const int whole = index_of_layer(source, [&](const Layer& l) { return l.name == name; });
  const int within = index_of_layer(source, [&](const Layer& l) { return place_of(l) == here && l.pass == name; });
  if (whole < 0 && within < 0) {
    const int other = index_of_layer(
        source, [&](const Layer& l) { return l.pass == name && is_of_another_picture(source, place_of(l)); });
    return other >= 0 ? elsewhere : add_channel(source, name);
  }
  if (whole < 0) return within;
  const Layer& named = source.layers[static_cast<std::size_t>(whole)];
  if (!is_of_another_picture(source, place_of(named))) return whole;
  const int twin = index_of_layer(source, [&](const Layer& l) {
    return place_of(l) == here && l.pass == named.pass && l.view_layer == named.view_layer;
  });
  return twin >= 0 ? twin : elsewhere;
}

void no_such_layer(const FrameSource& source, const std::string& name) {
  std::vector<std::string> names;
  for (const Layer& layer : source.layers) names.push_back(layer.name);
  std::vector<std::string> near = names;
  for (const Layer& layer : source.layers) near.push_back(layer.pass);
  throw Error(ExitCode::Missing, fmt::format("{}: no layer {}{}; there are: {}", source.path, name,
                                             did_you_mean(name, near), fmt::join(names, ", ")));
}

bool has_beauty(const FrameSource& source, std::string Layer::*place, const std::string& name) {
  return std::any_of(source.layers.begin(), source.layers.end(), [&](const Layer& l) {
    return l.*place == name && l.role == Role::Beauty && l.companion == Companion::Mean;
  });
}

int find_mean(const FrameSource& source, const LayerView& place, Role role, bool readable) {
  int best = -1;
  const auto key = [&](const Layer& l) {
    return std::make_tuple(l.rank != rank_by_hand, l.view != place.view, l.view_layer != place.view_layer, l.rank);
  };
  for (std::size_t i = 0; i < source.layers.size(); ++i) {
    const Layer& layer = source.layers[i];
    if (layer.role != role || layer.companion != Companion::Mean) continue;
    if (layer.view != place.view && (!layer.view.empty() || has_beauty(source, &Layer::view, ""))) continue;
    if (layer.view_layer != place.view_layer && has_beauty(source, &Layer::view_layer, layer.view_layer)) continue;
    if (part_of(source, layer).readable() != readable) continue;
    if (best < 0 || key(layer) < key(source.layers[static_cast<std::size_t>(best)])) best = static_cast<int>(i);
  }
  return best;
}

int find_mean(const FrameSource& source, Role role, bool readable) {
  return find_mean(source, place_of(source), role, readable);
}

}  // namespace polyrecon
