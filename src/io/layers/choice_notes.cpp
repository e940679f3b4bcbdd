#include "io/layers/choice_notes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "io/layers/channel_names.h"
#include "io/layers/choose_picture.h"
#include "io/layers/layer_search.h"
#include "io/layers/layer_words.h"
#include "io/renderers/known_names.h"
#include "io/renderers/polyrecon.h"

namespace polyrecon {
namespace {

std::vector<Role> features_of(const FrameSource& source, const LayerView& place) {
  std::vector<Role> roles;
  for (const RoleInfo& info : role_table())
    if (info.feature && find_mean(source, place, info.role) >= 0) roles.push_back(info.role);
  return roles;
}

}  // namespace

void note_misshapen(LayerChoice& choice, const RoleInfo& info) {
  const FrameSource& source = choice.source;
  for (const Layer& layer : source.layers) {
    const auto known = classify_pass(layer.pass);
    if (!known || known->role != info.role || layer.view != source.view || layer.view_layer != source.view_layer ||
        is_shaped(info.role, layer))
      continue;
    choice.notes.push_back(fmt::format("{} is not used as {}: it has {} channels; --map {}=LAYER names another layer",
                                       layer.name, info.name, layer.channels.size(), info.name));
  }
}

void note_seeming(LayerChoice& choice, const RoleInfo& info) {
  const FrameSource& source = choice.source;
  for (const Layer& layer : source.layers)
    if (layer.companion == Companion::Mean && !is_of_another_picture(source, place_of(layer)) &&
        is_shaped(info.role, layer) && feature_in_words(layer.pass) == info.role)
      choice.notes.push_back(fmt::format(
          "{} is not used: no known renderer gives this name to a pass; if it is the {}, --map {}={} uses it",
          layer.name, info.name, info.name, layer.name));
}

void note_lone_variances(LayerChoice& choice, const ReadOptions& options) {
  const FrameSource& source = choice.source;
  const PassChoice& beauty = choice.passes.front();
  if (beauty.variance >= 0 || beauty.half_a >= 0 || !options.own_windows.empty()) return;
  for (const Layer& layer : source.layers) {
    if (layer.companion != Companion::Mean || layer.rank == rank_by_hand ||
        is_of_another_picture(source, place_of(layer)))
      continue;
    const auto known = variance_by_name(layer);
    if (!known || info_of(layer.role).in_fit) continue;
    choice.notes.push_back(fmt::format(
        "{} is not used: it is the {} of {} by its name, and no layer {} has as many channels; write both, or name the "
        "beauty's variance by --map variance=LAYER",
        layer.name, name_of(known->companion), known->mean, known->mean));
  }
}

void note_pictures(LayerChoice& choice, const ReadOptions& options) {
  const auto& pictures = choice.source.pictures;
  if (pictures.size() < 2 || options.picture) return;
  std::vector<std::string> names;
  for (const LayerView& place : pictures) {
    const std::string name = name_of(place);
    names.push_back(name.empty() ? "the layers without a view layer" : name);
  }
  choice.notes.push_back(
      fmt::format("{} pictures with a beauty, which denoise takes one after the other: {}; "
                  "--view-layer and --view choose",
                  pictures.size(), fmt::join(names, "; ")));
}

void note_uneven_pictures(LayerChoice& choice, const ReadOptions& options) {
  const auto& pictures = choice.source.pictures;
  if (pictures.size() < 2 || options.picture) return;
  std::vector<std::vector<Role>> features;
  features.reserve(pictures.size());
  for (const LayerView& place : pictures) features.push_back(features_of(choice.source, place));
  const auto most =
      static_cast<std::size_t>(std::max_element(features.begin(), features.end(),
                                                [](const auto& a, const auto& b) { return a.size() < b.size(); }) -
                               features.begin());
  for (std::size_t p = 0; p < pictures.size(); ++p) {
    std::vector<const char*> lacking;
    for (const Role role : features[most])
      if (std::find(features[p].begin(), features[p].end(), role) == features[p].end())
        lacking.push_back(name_of(role));
    if (!lacking.empty())
      choice.notes.push_back(fmt::format("{} is denoised without {}, which {} has; {} and --map {}=LAYER name another",
                                         name_of(pictures[p]), fmt::join(lacking, ", "), name_of(pictures[most]),
                                         pictures[p].view.empty() ? "--view-layer" : "--view", lacking.front()));
  }
}

void note_other_beauties(LayerChoice& choice, const ReadOptions& options) {
  const FrameSource& source = choice.source;
  const Layer& chosen = source.layers[static_cast<std::size_t>(choice.passes.front().mean)];
  if (!options.own_windows.empty() || chosen.rank == rank_by_hand) return;
  for (const Layer& layer : source.layers) {
    const bool is_aov = std::any_of(choice.passes.begin(), choice.passes.end(), [&](const PassChoice& pass) {
      return source.layers[static_cast<std::size_t>(pass.mean)].name == layer.name;
    });
    if (layer.role != Role::Beauty || layer.companion != Companion::Mean || is_aov || layer.file > 0 ||
        !(place_of(layer) == place_of(source)))
      continue;
    choice.notes.push_back(fmt::format("{} stays as it is: the beauty is {}; --aov {} denoises it too", layer.name,
                                       chosen.name, layer.name));
  }
}

void note_lone_eye(LayerChoice& choice, const ReadOptions& options) {
  const FrameSource& source = choice.source;
  if (options.picture || !options.own_windows.empty() || source.pictures.size() != 1) return;
  const auto has = [&](const char* eye) {
    return std::any_of(source.layers.begin(), source.layers.end(), [&](const Layer& l) { return l.pass == eye; });
  };
  for (const Layer& layer : source.layers) {
    const bool is_eye = (layer.pass == "left" || layer.pass == "right") && !(has("left") && has("right"));
    const bool is_aov = std::any_of(choice.passes.begin(), choice.passes.end(), [&](const PassChoice& pass) {
      return source.layers[static_cast<std::size_t>(pass.mean)].name == layer.name;
    });
    if (is_eye && !is_aov && is_light_aov(layer) && place_of(layer) == place_of(source))
      choice.notes.push_back(fmt::format(
          "{} stays as it is: --aov {} denoises it if it is a light, --map beauty={} if it is the other eye",
          layer.name, layer.name, layer.name));
  }
}

void note_shared_samples(LayerChoice& choice, const ReadOptions& options) {
  if (options.picture) return;
  const AttributeInfo* note = find_attribute(choice.source.files.front().parts.front(), shared_samples_attribute);
  if (note) choice.notes.push_back(note->value);
}

void note_own_result(LayerChoice& choice, const Layer& beauty, const ReadOptions& options) {
  const FrameSource& source = choice.source;
  if (options.picture) return;  // noted with the first one
  const bool has_prior = std::any_of(choice.passes.begin(), choice.passes.end(), [&](const PassChoice& pass) {
    return pass.role == Role::Prior && source.layers[static_cast<std::size_t>(pass.mean)].file == 0;
  });
  if (!has_prior && is_result(source.files.front()))
    choice.notes.push_back(
        fmt::format("{} holds a result of this program: {} is denoised once more; give the render, or write results "
                    "with --outputs input,noisy",
                    source.path, beauty.name));
}

}  // namespace polyrecon
