#include "io/layers/choose_aovs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "io/layers/choose_picture.h"
#include "io/layers/layer_search.h"
#include "io/layers/layer_words.h"
#include "io/renderers/known_names.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// The index of a layer that the user wants to be denoised; elsewhere if other pictures have it. One channel of a
/// colour is refused: the others would stay noisy.
int find_aov(FrameSource& source, const std::string& name) {
  const std::size_t known = source.layers.size();
  const int index = find_layer(source, name);
  if (index == nowhere) no_such_layer(source, name);
  if (index < 0 || static_cast<std::size_t>(index) < known) return index;
  for (std::size_t l = 0; l < known; ++l) {
    const auto& channels = source.layers[l].channels;
    if (channels.size() > 1 && std::find(channels.begin(), channels.end(), name) != channels.end())
      throw Error(ExitCode::BadInput, fmt::format("{}: {} is one channel of layer {}; --aov {} denoises all of them",
                                                  source.path, name, source.layers[l].name, source.layers[l].name));
  }
  return index;
}

/// Whether one of the names is the whole name of a layer of this picture.
bool names_one_of(const FrameSource& source, const std::vector<std::string>& names) {
  return std::any_of(source.layers.begin(), source.layers.end(), [&](const Layer& layer) {
    return place_of(layer) == place_of(source) && std::find(names.begin(), names.end(), layer.name) != names.end();
  });
}

/// The light AOVs of the picture that can be denoised with its beauty.
std::vector<std::string> light_aovs(const FrameSource& source, const Layer& beauty) {
  std::vector<std::string> names;
  for (const Layer& layer : source.layers)
    if (is_light_aov(layer) && place_of(layer) == place_of(source) && part_of(source, layer).readable() &&
        misfit(part_of(source, layer), part_of(source, beauty)).empty())
      names.push_back(layer.name);
  return names;
}

/// The layers that the texts of --aov name, each once: lists, patterns and "all" are taken apart. Other names stay, and
/// so does a pattern that fits no layer of the file.
std::vector<std::string> aovs_named_by(const FrameSource& source, const std::vector<std::string>& texts,
                                       const std::vector<std::string>& light) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const std::string& text : texts)
    for (const std::string& word : layer_words(text, source.layers)) {
      const bool named = std::any_of(source.layers.begin(), source.layers.end(),
                                     [&](const Layer& layer) { return layer.name == word || layer.pass == word; });
      const auto fits = [&](const Layer& layer) { return fits_pattern(layer, word); };
      if (!named && word == "all") {
        for (const std::string& name : light) add(name);
      } else if (!named && is_layer_pattern(word) && std::any_of(source.layers.begin(), source.layers.end(), fits)) {
        for (const Layer& layer : source.layers)
          if (fits(layer) && std::find(light.begin(), light.end(), layer.name) != light.end()) add(layer.name);
      } else {
        add(word);
      }
    }
  return names;
}

}  // namespace

void choose_aovs(LayerChoice& choice, const ReadOptions& options) {
  FrameSource& source = choice.source;
  const Layer beauty = source.layers[static_cast<std::size_t>(choice.passes.front().mean)];
  const std::vector<std::string> light = light_aovs(source, beauty);
  for (const std::string& name : aovs_named_by(source, options.aovs, light)) {
    const int index = find_aov(source, name);
    if (index == elsewhere) {
      if (!names_one_of(source, options.aovs))
        choice.notes.push_back(fmt::format("{} has no layer {} to be denoised", name_of(place_of(source)), name));
      continue;
    }
    const Layer& layer = source.layers[static_cast<std::size_t>(index)];
    const PartInfo& part = part_of(source, layer);
    if (!part.readable() || !is_shaped(Role::Color, layer))
      throw Error(ExitCode::BadInput, fmt::format("{}: layer {} is no colour layer", source.path, layer.name));
    if (layer.file > 0)
      throw Error(ExitCode::BadInput,
                  fmt::format("{}: layer {} is in another file, which takes no result", source.path, layer.name));
    if (const std::string why = misfit(part, part_of(source, beauty)); !why.empty())
      throw Error(ExitCode::BadInput,
                  fmt::format("{}: layer {} cannot be denoised with the beauty: {}", source.path, layer.name, why));
    if (covers(part_of(source, beauty).data_window, part.data_window)) {
      PassChoice pass = with_companions(source, Role::Color, index);
      require_both_halves(choice, pass);
      choice.passes.push_back(pass);
      continue;
    }
    choice.outside_beauty.push_back(layer.name);
    choice.notes.push_back(
        fmt::format("{} gets windows of its own: its data window reaches beyond the beauty's, so it is no part of it "
                    "and does not add "
                    "up with the other layers",
                    layer.name));
  }
}

void note_divided_aovs(LayerChoice& choice) {
  std::vector<std::string> names;
  for (const PassChoice& pass : choice.passes) {
    const Layer& layer = choice.source.layers[static_cast<std::size_t>(pass.mean)];
    if (pass.role == Role::Color && is_divided(layer.pass)) names.push_back(layer.name);
  }
  if (names.empty()) return;
  choice.notes.push_back(fmt::format(
      "{} {} light without the colour of the surfaces: multiplied by the colour passes, {} up to about the "
      "beauty and not exactly; light groups add up",
      fmt::join(names, ", "), names.size() == 1 ? "is" : "are", names.size() == 1 ? "it adds" : "they add"));
}

}  // namespace polyrecon
