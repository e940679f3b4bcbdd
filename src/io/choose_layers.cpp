#include "io/choose_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <tuple>

#include "core/rect.h"
#include "io/channel_names.h"
#include "io/sibling_files.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

const PartInfo& part_of(const FrameSource& source, const Layer& layer) {
  return source.files[static_cast<std::size_t>(layer.file)].parts[static_cast<std::size_t>(layer.part)];
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
/// else the first.
const Layer& layer_for(const std::vector<Layer>& layers, Role wanted) {
  for (const Role role : {wanted, Role::Beauty})
    for (const Layer& layer : layers)
      if (layer.role == role && layer.companion == Companion::Mean) return layer;
  return layers.front();
}

/// Adds one layer of another file under the name `pass`.
void add_file(FrameSource& source, const std::string& path, const std::string& pass, Role role,
              const ReadLimits& limits) {
  source.files.push_back(describe_file(path, limits));
  const std::vector<Layer> layers = find_layers(source.files.back());
  if (layers.empty()) throw Error(ExitCode::BadInput, fmt::format("{}: no channels", path));
  Layer layer = layer_for(layers, role);
  layer.file = static_cast<int>(source.files.size()) - 1;
  layer.name = layer.pass = pass;
  layer.view_layer.clear();
  source.layers.push_back(std::move(layer));
}

/// Whether the file holds one pass without a name in the file.
bool is_one_bare_image(const FrameSource& source) {
  return source.layers.size() == 1 && source.layers.front().view_layer.empty() &&
         (source.layers.front().pass == bare_pass || source.layers.front().channels.size() == 1);
}

/// The index of a layer by its whole name or its name within the view layer. A channel's name adds a layer with this
/// channel alone. -1 where there is none.
int find_layer(FrameSource& source, const std::string& name, const std::string& view_layer) {
  auto& layers = source.layers;
  for (const std::string& candidate : {name, fmt::format("{}.{}", view_layer, name)})
    for (std::size_t l = 0; l < layers.size(); ++l)
      if (layers[l].name == candidate) return static_cast<int>(l);
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
  return -1;
}

[[noreturn]] void no_such_layer(const FrameSource& source, const std::string& name) {
  std::vector<std::string> names;
  for (const Layer& layer : source.layers) names.push_back(layer.name);
  throw Error(ExitCode::Missing,
              fmt::format("{}: no layer {}; there are: {}", source.path, name, fmt::join(names, ", ")));
}

bool has_beauty(const FrameSource& source, const std::string& view_layer) {
  return std::any_of(source.layers.begin(), source.layers.end(), [&](const Layer& l) {
    return l.view_layer == view_layer && l.role == Role::Beauty && l.companion == Companion::Mean;
  });
}

void choose_view_layer(FrameSource& source, const ReadOptions& options) {
  const auto beauty = std::find_if(source.layers.begin(), source.layers.end(), [&](const Layer& l) {
    return l.role == Role::Beauty && l.companion == Companion::Mean &&
           (options.view_layer.empty() || l.view_layer == options.view_layer) &&
           (options.view.empty() || l.view == options.view);
  });
  source.view_layer = options.view_layer;
  source.view = options.view;
  if (beauty != source.layers.end()) {
    source.view_layer = beauty->view_layer;
    source.view = beauty->view;
  } else if (!options.view_layer.empty() &&
             std::none_of(source.layers.begin(), source.layers.end(),
                          [&](const Layer& l) { return l.view_layer == options.view_layer; })) {
    throw Error(ExitCode::Missing, fmt::format("{}: no view layer {}", source.path, options.view_layer));
  }
}

/// Sets the roles that the user gives; companions after the means that they accompany.
void apply_map(FrameSource& source, const ReadOptions& options) {
  const auto files_of_frame = static_cast<int>(source.files.size());
  for (const bool means : {true, false})
    for (const RoleMapping& mapping : options.map) {
      if ((mapping.companion == Companion::Mean) != means) continue;
      int index = find_layer(source, mapping.layer, source.view_layer);
      std::error_code failure;
      const bool added = index >= 0 && source.layers[static_cast<std::size_t>(index)].file >= files_of_frame;
      if ((index < 0 || added) && std::filesystem::is_regular_file(mapping.layer, failure)) {
        add_file(source, mapping.layer, mapping.layer, mapping.role, options.limits);
        index = static_cast<int>(source.layers.size()) - 1;
      }
      if (index < 0) no_such_layer(source, mapping.layer);
      Layer& layer = source.layers[static_cast<std::size_t>(index)];
      layer.role = mapping.role;
      layer.companion = mapping.companion;
      layer.rank = rank_by_hand;
      layer.view = source.view;
      layer.view_layer = source.view_layer;
      layer.of.clear();
      layer.why = "named by hand";
    }
}

/// The mean for a role: a layer that the user named, else one of the chosen view layer, else one of a view layer
/// without a beauty (nested layers); among these the one of lowest rank, then the first in the file. Layers of parts
/// that cannot be read are skipped.
int find_mean(const FrameSource& source, Role role, bool readable = true) {
  int best = -1;
  const auto key = [&](const Layer& l) {
    return std::make_tuple(l.rank != rank_by_hand, l.view_layer != source.view_layer, l.rank);
  };
  for (std::size_t i = 0; i < source.layers.size(); ++i) {
    const Layer& layer = source.layers[i];
    if (layer.role != role || layer.companion != Companion::Mean || layer.view != source.view) continue;
    if (layer.view_layer != source.view_layer && has_beauty(source, layer.view_layer)) continue;
    if (part_of(source, layer).readable() != readable) continue;
    if (best < 0 || key(layer) < key(source.layers[static_cast<std::size_t>(best)])) best = static_cast<int>(i);
  }
  return best;
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
  if (pass.half_a < 0 || pass.half_b < 0) pass.half_a = pass.half_b = -1;
  return pass;
}

[[noreturn]] void no_beauty(const FrameSource& source) {
  if (const int beauty = find_mean(source, Role::Beauty, false); beauty >= 0)
    throw Error(ExitCode::BadInput,
                fmt::format("{}: the beauty is {}", source.path,
                            part_of(source, source.layers[static_cast<std::size_t>(beauty)]).obstacle()));
  const std::vector<PartInfo>& parts = source.files.front().parts;
  if (std::none_of(parts.begin(), parts.end(), [](const PartInfo& part) { return part.readable(); }))
    throw Error(ExitCode::BadInput, fmt::format("{}: the image is {}", source.path, parts.front().obstacle()));
  std::vector<std::string> names;
  for (const Layer& layer : source.layers) names.push_back(layer.name);
  throw Error(ExitCode::Missing, fmt::format("{}: no beauty among the layers {}; name it with --map beauty=LAYER",
                                             source.path, fmt::join(names, ", ")));
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
  if (pass.half_a < 0 || pass.half_b < 0) pass.half_a = pass.half_b = -1;
}

/// Adds the layers that the user wants to be denoised with the beauty.
void choose_aovs(LayerChoice& choice, const ReadOptions& options) {
  FrameSource& source = choice.source;
  const auto& beauty = source.layers[static_cast<std::size_t>(choice.passes.front().mean)];
  for (const std::string& name : options.aovs) {
    const int index = find_layer(source, name, source.view_layer);
    if (index < 0) no_such_layer(source, name);
    const Layer& layer = source.layers[static_cast<std::size_t>(index)];
    const PartInfo& part = part_of(source, layer);
    if (!part.readable() || !info_of(Role::Color).layer_channels.allow(layer.channels.size()))
      throw Error(ExitCode::BadInput, fmt::format("{}: layer {} is no colour layer", source.path, layer.name));
    if (const std::string why = misfit(part, part_of(source, beauty)); !why.empty())
      throw Error(ExitCode::BadInput,
                  fmt::format("{}: layer {} cannot be denoised with the beauty: {}", source.path, layer.name, why));
    choice.passes.push_back(with_companions(source, Role::Color, index));
  }
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

/// The beauty's alpha channel, unless the user named another layer or the beauty has none.
void choose_alpha(LayerChoice& choice, const Layer& beauty) {
  FrameSource& source = choice.source;
  if (!beauty.alpha.empty()) source.alpha_layer = beauty.name;
  for (const PassChoice& pass : choice.passes) {
    if (pass.role != Role::Alpha) continue;
    const Layer& alpha = source.layers[static_cast<std::size_t>(pass.mean)];
    if (beauty.alpha.empty() || alpha.rank == rank_by_hand) source.alpha_layer = alpha.name;
  }
}

}  // namespace

FrameSource open_source(const std::string& path, const ReadLimits& limits, std::vector<std::string>& notes) {
  FrameSource source;
  source.path = path;
  source.files.push_back(describe_file(path, limits));
  source.layers = find_layers(source.files.front());
  if (!is_one_bare_image(source)) return source;
  const auto siblings = find_siblings(path);
  if (siblings.empty()) return source;
  source.layers.front().name = source.layers.front().pass = pass_in_file_name(path);
  std::vector<std::string> names;
  for (const SiblingFile& sibling : siblings) {
    add_file(source, sibling.path, sibling.pass, Role::Other, limits);
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
  choose_view_layer(source, options);
  apply_map(source, options);
  const int beauty = find_mean(source, Role::Beauty);
  if (beauty < 0) no_beauty(source);
  choice.passes.push_back(with_companions(source, Role::Beauty, beauty));
  drop_misfits(choice, choice.passes.front());
  for (const RoleInfo& info : role_table()) {
    if (!info.chosen || info.role == Role::Beauty || (info.on_request && !options.motion)) continue;
    const int mean = find_mean(source, info.role);
    if (mean < 0) continue;
    PassChoice pass = with_companions(source, info.role, mean);
    drop_misfits(choice, pass);
    if (pass.mean >= 0) choice.passes.push_back(pass);
  }
  choose_aovs(choice, options);
  choose_alpha(choice, source.layers[static_cast<std::size_t>(beauty)]);
  describe_choice(choice);
  return choice;
}

}  // namespace polyrecon
