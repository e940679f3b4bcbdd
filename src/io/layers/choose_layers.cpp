#include "io/layers/choose_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "io/files/file.h"
#include "io/layers/channel_groups.h"
#include "io/layers/channel_names.h"
#include "io/layers/choice_notes.h"
#include "io/layers/choose_aovs.h"
#include "io/layers/choose_picture.h"
#include "io/layers/layer_search.h"
#include "io/layers/open_source.h"
#include "io/renderers/known_names.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

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

void describe_choice(LayerChoice& choice) {
  FrameSource& source = choice.source;
  for (const PassChoice& pass : choice.passes)
    for (const int index : {pass.mean, pass.variance, pass.half_a, pass.half_b}) {
      if (index < 0) continue;
      const Layer& layer = source.layers[static_cast<std::size_t>(index)];
      source.chosen.push_back({pass.role, layer.companion, layer.name, layer.why});
    }
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
    layer.role = Role::Beauty;  // even if it is a feature by name, such as a shadow
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
  note_lone_variances(choice, options);
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
