#include "io/layers/choose_picture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

bool contains(const std::vector<LayerView>& pictures, const LayerView& place) {
  return std::find(pictures.begin(), pictures.end(), place) != pictures.end();
}

/// The places of the layers that fit, each once, in the order of the file.
template <class Fits>
std::vector<LayerView> places_where(const FrameSource& source, const ReadOptions& options, const Fits& fits) {
  std::vector<LayerView> places;
  for (const Layer& layer : source.layers) {
    const LayerView place = place_of(layer);
    const bool selected = (options.view_layer.empty() || layer.view_layer == options.view_layer) &&
                          (options.view.empty() || layer.view == options.view);
    if (selected && fits(layer) && !contains(places, place)) places.push_back(place);
  }
  return places;
}

/// The places of a layer that the user names: that of the whole name, else all that have a layer or a channel with it.
std::vector<LayerView> places_named(const FrameSource& source, const ReadOptions& options, const std::string& name) {
  const auto has_channel = [&](const Layer& l) {
    return l.alpha == name || std::find(l.channels.begin(), l.channels.end(), name) != l.channels.end();
  };
  auto places = places_where(source, options, [&](const Layer& l) { return l.name == name; });
  if (places.empty()) places = places_where(source, options, [&](const Layer& l) { return l.pass == name; });
  return places.empty() ? places_where(source, options, has_channel) : places;
}

std::vector<LayerView> pictures_of(const FrameSource& source, const ReadOptions& options) {
  for (const RoleMapping& mapping : options.map)
    if (mapping.role == Role::Beauty && mapping.companion == Companion::Mean)
      if (auto places = places_named(source, options, mapping.layer); !places.empty()) return places;
  return places_where(source, options,
                      [](const Layer& l) { return l.role == Role::Beauty && l.companion == Companion::Mean; });
}

/// Throws where no layer has the view layer, or the view, that the user wants.
void require_known(const FrameSource& source, const std::string& wanted, const char* kind, std::string Layer::*name) {
  std::set<std::string> known;
  for (const Layer& layer : source.layers) known.insert(layer.*name);
  if (wanted.empty() || known.count(wanted) > 0) return;
  known.erase("");
  throw Error(ExitCode::Missing, fmt::format("{}: no {} {}; there are: {}", source.path, kind, wanted,
                                             known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
}

}  // namespace

bool is_of_another_picture(const FrameSource& source, const LayerView& place) {
  return source.pictures.size() > 1 && !(place == place_of(source)) && contains(source.pictures, place);
}

void choose_picture(FrameSource& source, const ReadOptions& options) {
  require_known(source, options.view_layer, "view layer", &Layer::view_layer);
  require_known(source, options.view, "view", &Layer::view);
  source.pictures = pictures_of(source, options);
  LayerView place{options.view_layer, options.view};
  if (options.picture) {
    place = *options.picture;
    if (!contains(source.pictures, place))
      throw Error(ExitCode::Missing, fmt::format("{}: no beauty in {}", source.path, name_of(place)));
  } else if (!source.pictures.empty()) {
    place = source.pictures.front();
  }
  source.view_layer = place.view_layer;
  source.view = place.view;
}

}  // namespace polyrecon
