#include "io/layers/choose_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <tuple>

#include "core/nearest.h"
#include "core/rect.h"
#include "io/layers/channel_groups.h"
#include "io/layers/channel_names.h"
#include "io/layers/choose_picture.h"
#include "io/layers/layer_words.h"
#include "io/layers/sibling_files.h"
#include "io/renderers/known_names.h"
#include "io/renderers/polyrecon.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

const PartInfo& part_of(const FrameSource& source, const Layer& layer) {
  return source.files[static_cast<std::size_t>(layer.file)].parts[static_cast<std::size_t>(layer.part)];
}

/// Names the part of a layer in a file of several parts: " (part 2 "right")".
std::string in_part(const FrameSource& source, const Layer& layer) {
  const FileInfo& file = source.files[static_cast<std::size_t>(layer.file)];
  return file.parts.size() == 1 ? std::string() : fmt::format(" ({})", title_of(file, layer.part));
}

bool covers(const Rect& outer, const Rect& inner) { return intersect(outer, inner) == inner; }

/// Why a part cannot be laid over another one; empty where it can. Parts of one picture may be cut to boxes of their
/// own, as renderers do that leave black margins out; a part of another picture size is no pass of the same frame.
std::string misfit(const PartInfo& part, const PartInfo& beauty) {
  if (!(part.display_window == beauty.display_window) && !covers(part.data_window, beauty.data_window))
    return "its display window is not the beauty's, nor does its data window contain the beauty's";
  if (intersect(part.data_window, beauty.data_window).empty()) return "its data window lies outside the beauty's";
  return {};
}

/// The layer of a file that is used where the file itself is named for a role: the one with that role, else the beauty,
/// else the first; in the view layer and view of the frame where the file has them.
const Layer& layer_for(const std::vector<Layer>& layers, Role wanted, const LayerView& place) {
  for (const bool same_place : {true, false})
    for (const Role role : {wanted, Role::Beauty})
      for (const Layer& layer : layers)
        if (layer.role == role && layer.companion == Companion::Mean && (!same_place || place_of(layer) == place))
          return layer;
  return layers.front();
}

/// Adds one layer of another file. Returns its index.
int add_file(FrameSource& source, const std::string& path, Role role, const ReadLimits& limits) {
  source.files.push_back(describe_file(path, limits));
  const std::vector<Layer> layers = find_layers(source.files.back());
  if (layers.empty()) throw Error(ExitCode::BadInput, fmt::format("{}: no channels", path));
  source.layers.push_back(layer_for(layers, role, place_of(source)));
  source.layers.back().file = static_cast<int>(source.files.size()) - 1;
  return static_cast<int>(source.layers.size()) - 1;
}

/// Names a layer of another file after the pass that it holds.
void rename_layer(Layer& layer, const std::string& pass, const LayerView& place = {}) {
  layer.name = layer.pass = pass;
  layer.view_layer = place.view_layer;
  if (!place.view.empty()) layer.view = place.view;
}

bool has_mean(const FrameSource& source, Role role) {
  return std::any_of(source.layers.begin(), source.layers.end(),
                     [&](const Layer& l) { return l.role == role && l.companion == Companion::Mean; });
}

/// Whether the file holds one pass without a name in the file.
bool is_one_bare_image(const FrameSource& source) {
  return source.layers.size() == 1 && source.layers.front().view_layer.empty() &&
         (is_bare_name(source.layers.front().pass) || source.layers.front().channels.size() == 1);
}

/// Whether files next to the input can hold passes that a file of several layers lacks: it has one picture, and not
/// every pass that renderers commonly write.
bool may_lack_passes(const FrameSource& source) {
  const Layer* beauty = picture_layer(source.layers);
  const auto elsewhere = [&](const Layer& l) {
    return l.role == Role::Beauty && l.companion == Companion::Mean && !(place_of(l) == place_of(*beauty));
  };
  const auto is_common_and_lacking = [&](const RoleInfo& info) {
    return info.surface != Surface::None && !has_mean(source, info.role);
  };
  return beauty && std::none_of(source.layers.begin(), source.layers.end(), elsewhere) &&
         std::any_of(role_table().begin(), role_table().end(), is_common_and_lacking);
}

/// Whether a file of several layers lacks the pass.
bool lacks(const FrameSource& source, const std::string& pass) {
  if (is_denoised_name(pass)) return !has_mean(source, Role::Prior);
  if (const auto known = classify_pass(pass)) return known->role != Role::Beauty && !has_mean(source, known->role);
  return std::none_of(source.layers.begin(), source.layers.end(),
                      [](const Layer& l) { return l.role == Role::Beauty && l.companion != Companion::Mean; });
}

/// The name of a sibling's layer. The beauty of a file of several layers keeps the name that it has there, so that its
/// companions are called after it.
std::string layer_name(const std::string& sibling, const std::string& in_file_name, const Layer& beauty) {
  const std::size_t begin = in_file_name.size();
  if (in_file_name.empty() || sibling.size() <= begin || sibling.compare(0, begin, in_file_name) != 0) return sibling;
  return beauty.pass + sibling.substr(begin);
}

constexpr int nowhere = -1, elsewhere = -2;  // results of find_layer

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

/// The index of a layer by its whole name or its name within the view layer and view. A channel's name adds a layer
/// with this channel alone. A name of one view stands for the same pass of the others. elsewhere: only other pictures
/// of the file have such a layer; nowhere: none has.
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

[[noreturn]] void no_such_layer(const FrameSource& source, const std::string& name) {
  std::vector<std::string> names;
  for (const Layer& layer : source.layers) names.push_back(layer.name);
  std::vector<std::string> near = names;
  for (const Layer& layer : source.layers) near.push_back(layer.pass);
  throw Error(ExitCode::Missing, fmt::format("{}: no layer {}{}; there are: {}", source.path, name,
                                             did_you_mean(name, near), fmt::join(names, ", ")));
}

/// Whether a beauty has this view layer, or this view.
bool has_beauty(const FrameSource& source, std::string Layer::*place, const std::string& name) {
  return std::any_of(source.layers.begin(), source.layers.end(), [&](const Layer& l) {
    return l.*place == name && l.role == Role::Beauty && l.companion == Companion::Mean;
  });
}

/// Takes the only colour layer for the beauty where no layer has the name of one and the user names none.
void adopt_beauty(LayerChoice& choice, const ReadOptions& options) {
  auto& layers = choice.source.layers;
  const auto is_beauty = [](const auto& l) { return l.role == Role::Beauty && l.companion == Companion::Mean; };
  if (std::any_of(layers.begin(), layers.end(), is_beauty) ||
      std::any_of(options.map.begin(), options.map.end(), is_beauty) || !adopt_only_color(layers))
    return;
  choice.notes.push_back(
      fmt::format("{} is taken for the beauty: it is the only colour layer; --map beauty=LAYER names another layer",
                  std::find_if(layers.begin(), layers.end(), is_beauty)->name));
}

bool is_shaped(Role role, const Layer& layer) { return info_of(role).layer_channels.allow(layer.channels.size()); }

/// Refuses a layer that the user names for a role and that cannot have it.
void require_fitting(const FrameSource& source, const Layer& layer, const RoleMapping& mapping) {
  const RoleInfo& info = info_of(mapping.role);
  if (!part_of(source, layer).readable())
    throw Error(ExitCode::BadInput, fmt::format("{}: layer {}{} is {}", source.path, layer.name, in_part(source, layer),
                                                part_of(source, layer).obstacle()));
  if (mapping.role == Role::Beauty && mapping.companion == Companion::Mean && layer.file > 0)
    throw Error(ExitCode::BadInput,
                fmt::format("{}: the beauty is a layer of the input, which takes the result; denoise {} instead",
                            source.path, mapping.layer));
  if (!is_shaped(mapping.role, layer))
    throw Error(ExitCode::BadInput,
                fmt::format("{}: layer {} cannot be the {}: it has the {} channels {}", source.path, layer.name,
                            info.name, layer.channels.size(), fmt::join(layer.channels, ", ")));
}

/// The index of the layer that the user maps: of the file, or of another file, which is added. Below 0, with a note:
/// the layer belongs to another picture.
int mapped_layer(LayerChoice& choice, const RoleMapping& mapping, const ReadOptions& options, int files_of_frame) {
  FrameSource& source = choice.source;
  const std::string& file = mapping.file.empty() ? mapping.layer : mapping.file;
  int index = find_layer(source, mapping.layer);
  std::error_code failure;
  const bool added = index >= 0 && source.layers[static_cast<std::size_t>(index)].file >= files_of_frame;
  if ((index < 0 || added) && std::filesystem::exists(file, failure)) {
    index = add_file(source, file, mapping.role, options.limits);
    Layer& layer = source.layers[static_cast<std::size_t>(index)];
    const bool of_another = source.pictures.size() > 1 && !(place_of(layer) == place_of(source)) &&
                            !(place_of(source) == source.pictures.front());
    rename_layer(layer, file);
    if (of_another) index = elsewhere;
  }
  if (index == nowhere) no_such_layer(source, file);
  if (index == elsewhere)
    choice.notes.push_back(fmt::format("{} is not used as {} of {}: it has no such layer", file, name_of(mapping.role),
                                       name_of(place_of(source))));
  return index;
}

/// Sets the roles that the user gives; companions after the means that they accompany.
void apply_map(LayerChoice& choice, const ReadOptions& options) {
  FrameSource& source = choice.source;
  const auto files_of_frame = static_cast<int>(source.files.size());
  for (const bool means : {true, false})
    for (const RoleMapping& mapping : options.map) {
      if ((mapping.companion == Companion::Mean) != means) continue;
      const int index = mapped_layer(choice, mapping, options, files_of_frame);
      if (index < 0) continue;
      Layer& layer = source.layers[static_cast<std::size_t>(index)];
      require_fitting(source, layer, mapping);
      layer.role = mapping.role;
      // The kind of variance that a layer holds is known from its name, not from --map.
      if (mapping.companion != Companion::VarianceOfMean || !is_variance(layer.companion))
        layer.companion = mapping.companion;
      layer.rank = rank_by_hand;
      layer.view = source.view;
      layer.view_layer = source.view_layer;
      layer.of.clear();
      layer.why = "named by hand";
    }
}

/// The mean for a role: a layer that the user named, else one of the chosen view layer, else one of a view layer
/// without a beauty (nested layers); among these the one of lowest rank, then the first in the file. Layers without a
/// view belong to every view where no beauty is without one. Layers of parts that cannot be read are skipped.
int find_mean(const FrameSource& source, const LayerView& place, Role role, bool readable = true) {
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

int find_mean(const FrameSource& source, Role role, bool readable = true) {
  return find_mean(source, place_of(source), role, readable);
}

/// The companion of a mean that is wanted(companion): one that the user named, else the first in the file; -1 without
/// one.
template <class Wanted>
int find_companion(const FrameSource& source, const Layer& mean, Wanted wanted) {
  int best = -1;
  for (std::size_t i = 0; i < source.layers.size(); ++i) {
    const Layer& layer = source.layers[i];
    const bool by_hand = layer.rank == rank_by_hand && layer.of.empty() && layer.role == mean.role;
    if (!wanted(layer.companion) || !part_of(source, layer).readable()) continue;
    if (!by_hand && (layer.of != mean.name || layer.view != mean.view)) continue;
    if (by_hand) return static_cast<int>(i);
    if (best < 0) best = static_cast<int>(i);
  }
  return best;
}

PassChoice with_companions(const FrameSource& source, Role role, int mean) {
  const Layer& layer = source.layers[static_cast<std::size_t>(mean)];
  PassChoice pass{role, mean};
  pass.variance = find_companion(source, layer, is_variance);
  pass.half_a = find_companion(source, layer, [](Companion c) { return c == Companion::HalfA; });
  pass.half_b = find_companion(source, layer, [](Companion c) { return c == Companion::HalfB; });
  return pass;
}

/// The layer that has the name of a beauty without its number of channels; nullptr without one.
const Layer* misshapen_beauty(const FrameSource& source) {
  for (const Layer& layer : source.layers)
    if (const auto known = classify_pass(layer.pass);
        known && known->role == Role::Beauty && !is_shaped(known->role, layer))
      return &layer;
  return nullptr;
}

/// The layer that would be the beauty had the user not named it for another role; nullptr without one.
const Layer* beauty_named_for_another_role(const FrameSource& source) {
  for (const Layer& layer : source.layers) {
    const auto known = classify_pass(layer.pass);
    const bool is_beauty = (known && known->role == Role::Beauty) || is_bare_name(layer.pass);
    if (is_beauty && layer.file == 0 && layer.rank == rank_by_hand) return &layer;
  }
  return nullptr;
}

[[noreturn]] void no_beauty(const FrameSource& source) {
  if (const int beauty = find_mean(source, Role::Beauty, false); beauty >= 0) {
    const Layer& layer = source.layers[static_cast<std::size_t>(beauty)];
    throw Error(ExitCode::BadInput, fmt::format("{}: the beauty{} is {}", source.path, in_part(source, layer),
                                                part_of(source, layer).obstacle()));
  }
  const std::vector<PartInfo>& parts = source.files.front().parts;
  if (std::none_of(parts.begin(), parts.end(), [](const PartInfo& part) { return part.readable(); }))
    throw Error(ExitCode::BadInput, fmt::format("{}: {} is {}", source.path,
                                                parts.size() == 1 ? "the image" : title_of(source.files.front(), 0),
                                                parts.front().obstacle()));
  if (const Layer* layer = beauty_named_for_another_role(source))
    throw Error(ExitCode::Missing,
                fmt::format("{}: layer {} is the beauty and cannot be the {} too; name another layer", source.path,
                            layer->name, name_of(layer->role)));
  if (const Layer* layer = misshapen_beauty(source))
    throw Error(
        ExitCode::Missing,
        fmt::format("{}: layer {} is no beauty: it has the {} channels {}; name another with --map beauty=LAYER",
                    source.path, layer->name, layer->channels.size(), fmt::join(layer->channels, ", ")));
  std::vector<std::string> names;
  for (const Layer& layer : source.layers) names.push_back(layer.name);
  throw Error(ExitCode::Missing, fmt::format("{}: no beauty among the layers {}; name it with --map beauty=LAYER",
                                             source.path, fmt::join(names, ", ")));
}

/// Notes a layer that has the name of a role without the number of channels that the role needs.
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

/// Notes layers that seem to be the feature by the words of their names, which no renderer is known to use.
void note_seeming(LayerChoice& choice, const RoleInfo& info) {
  const FrameSource& source = choice.source;
  for (const Layer& layer : source.layers)
    if (layer.companion == Companion::Mean && !is_of_another_picture(source, place_of(layer)) &&
        is_shaped(info.role, layer) && feature_in_words(layer.pass) == info.role)
      choice.notes.push_back(fmt::format(
          "{} is not used: no known renderer gives this name to a pass; if it is the {}, --map {}={} uses it",
          layer.name, info.name, info.name, layer.name));
}

/// Leaves out one half without the other, with a note if the user named it.
void require_both_halves(LayerChoice& choice, PassChoice& pass) {
  if ((pass.half_a < 0) == (pass.half_b < 0)) return;
  const Layer& half = choice.source.layers[static_cast<std::size_t>(std::max(pass.half_a, pass.half_b))];
  if (half.rank == rank_by_hand)
    choice.notes.push_back(fmt::format("{} is not used: it is one half without the other, which --map {}{}=LAYER names",
                                       half.name,
                                       pass.role == Role::Beauty ? "" : fmt::format("{}-", name_of(pass.role)),
                                       pass.half_a < 0 ? "half-a" : "half-b"));
  pass.half_a = pass.half_b = -1;
}

/// Drops the layers of a pass that cannot be laid over the beauty.
void drop_misfits(LayerChoice& choice, PassChoice& pass) {
  const FrameSource& source = choice.source;
  const Layer& beauty = source.layers[static_cast<std::size_t>(choice.passes.front().mean)];
  for (int* index : {&pass.variance, &pass.half_a, &pass.half_b, &pass.mean}) {
    if (*index < 0) continue;
    const Layer& layer = source.layers[static_cast<std::size_t>(*index)];
    const std::string why = misfit(part_of(source, layer), part_of(source, beauty));
    if (why.empty()) continue;
    choice.notes.push_back(fmt::format("{} is not used: {}", layer.name, why));
    *index = -1;
  }
  require_both_halves(choice, pass);
}

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

/// Adds the layers that the user wants to be denoised with the beauty.
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

/// Notes colour layers whose sums are no beauty, whatever is done to them.
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

void describe_choice(LayerChoice& choice) {
  FrameSource& source = choice.source;
  for (const PassChoice& pass : choice.passes)
    for (const int index : {pass.mean, pass.variance, pass.half_a, pass.half_b}) {
      if (index < 0) continue;
      const Layer& layer = source.layers[static_cast<std::size_t>(index)];
      source.chosen.push_back({pass.role, layer.companion, layer.name, layer.why});
    }
}

/// Notes that the file has several pictures, unless one of them was chosen.
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

std::vector<Role> features_of(const FrameSource& source, const LayerView& place) {
  std::vector<Role> roles;
  for (const RoleInfo& info : role_table())
    if (info.feature && find_mean(source, place, info.role) >= 0) roles.push_back(info.role);
  return roles;
}

/// Notes the pictures without features that another picture of the file has, before any of them was chosen.
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

/// Notes the beauties that stay as they are: a picture has one.
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

/// Notes a layer with the name of one eye next to a beauty without a view: it may be a light, or the other eye.
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

/// Repeats what `merge` noted of the noise of the file.
void note_shared_samples(LayerChoice& choice, const ReadOptions& options) {
  if (options.picture) return;
  const AttributeInfo* note = find_attribute(choice.source.files.front().parts.front(), shared_samples_attribute);
  if (note) choice.notes.push_back(note->value);
}

/// Notes a picture that this program has denoised already.
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

/// The beauty's alpha channel, unless the user named another layer or the beauty has none. Then it is an alpha layer,
/// else the alpha of the beauty that the renderer's denoiser left.
void choose_alpha(LayerChoice& choice, const Layer& beauty) {
  FrameSource& source = choice.source;
  if (!beauty.alpha.empty()) source.alpha_layer = beauty.name;
  for (const PassChoice& pass : choice.passes) {
    const Layer& layer = source.layers[static_cast<std::size_t>(pass.mean)];
    if (pass.role == Role::Prior && layer.file == 0 && beauty.alpha.empty() && !layer.alpha.empty())
      source.alpha_layer = layer.name;
    if (pass.role == Role::Alpha && (beauty.alpha.empty() || layer.rank == rank_by_hand))
      source.alpha_layer = layer.name;
  }
}

/// The layer that is reconstructed.
int find_beauty(FrameSource& source, const ReadOptions& options) {
  if (!options.own_windows.empty()) {
    const int index = find_layer(source, options.own_windows);
    if (index < 0) no_such_layer(source, options.own_windows);
    Layer& layer = source.layers[static_cast<std::size_t>(index)];
    layer.role = Role::Beauty;  // it guides itself no more, as a shadow would
    layer.rank = rank_by_hand;
    return index;
  }
  const int beauty = find_mean(source, Role::Beauty);
  if (beauty < 0) no_beauty(source);
  if (const int file = source.layers[static_cast<std::size_t>(beauty)].file; file > 0)
    throw Error(ExitCode::Missing, fmt::format("{}: the beauty is in {}; denoise that file", source.path,
                                               source.files[static_cast<std::size_t>(file)].path));
  return beauty;
}

}  // namespace

FrameSource open_source(const std::string& path, const ReadLimits& limits, std::vector<std::string>& notes) {
  FrameSource source;
  source.path = path;
  source.files.push_back(describe_file(path, limits));
  source.layers = find_layers(source.files.front());
  const bool bare = is_one_bare_image(source);
  if (!bare && !may_lack_passes(source)) return source;
  std::vector<SiblingFile> siblings = find_siblings(path);
  siblings.erase(
      std::remove_if(siblings.begin(), siblings.end(),
                     [&](const SiblingFile& sibling) {
                       return (!bare && !lacks(source, sibling.pass)) ||
                              (is_denoised_name(sibling.pass) && is_result(describe_file(sibling.path, limits)));
                     }),
      siblings.end());
  if (siblings.empty()) return source;
  const std::string pass = pass_in_file_name(path);
  if (bare && !pass.empty()) source.layers.front().name = source.layers.front().pass = pass;
  const Layer beauty = bare ? source.layers.front() : *picture_layer(source.layers);
  std::vector<std::string> names;
  for (const SiblingFile& sibling : siblings) {
    const auto added = static_cast<std::size_t>(add_file(source, sibling.path, Role::Other, limits));
    rename_layer(source.layers[added], layer_name(sibling.pass, pass, beauty), place_of(beauty));
    names.push_back(std::filesystem::path(sibling.path).filename().string());
  }
  classify_layers(source.files, source.layers);
  notes.push_back(fmt::format("passes from files next to the input: {}", fmt::join(names, ", ")));
  return source;
}

LayerChoice choose_layers(const std::string& path, const ReadOptions& options) {
  LayerChoice choice;
  FrameSource& source = choice.source;
  source = open_source(path, options.limits, choice.notes);
  adopt_beauty(choice, options);
  choose_picture(source, options);
  note_pictures(choice, options);
  note_uneven_pictures(choice, options);
  apply_map(choice, options);
  const int beauty = find_beauty(source, options);
  choice.passes.push_back(with_companions(source, Role::Beauty, beauty));
  drop_misfits(choice, choice.passes.front());
  for (const RoleInfo& info : role_table()) {
    if (!info.chosen || info.role == Role::Beauty || (info.on_request && !options.motion)) continue;
    if (info.role == Role::Prior && !options.own_windows.empty()) continue;
    const int mean = find_mean(source, info.role);
    if (mean < 0) {
      note_misshapen(choice, info);
      note_seeming(choice, info);
      continue;
    }
    PassChoice pass = with_companions(source, info.role, mean);
    drop_misfits(choice, pass);
    if (pass.mean >= 0) choice.passes.push_back(pass);
  }
  choose_aovs(choice, options);
  note_divided_aovs(choice);
  note_other_beauties(choice, options);
  note_lone_eye(choice, options);
  note_shared_samples(choice, options);
  note_own_result(choice, source.layers[static_cast<std::size_t>(beauty)], options);
  choose_alpha(choice, source.layers[static_cast<std::size_t>(beauty)]);
  describe_choice(choice);
  return choice;
}

}  // namespace polyrecon
