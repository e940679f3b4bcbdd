#include "io/layers/open_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "io/files/file.h"
#include "io/layers/channel_groups.h"
#include "io/layers/channel_names.h"
#include "io/layers/choose_picture.h"
#include "io/layers/sibling_files.h"
#include "io/renderers/known_names.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

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

bool has_mean(const FrameSource& source, Role role) {
  return std::any_of(source.layers.begin(), source.layers.end(),
                     [&](const Layer& l) { return l.role == role && l.companion == Companion::Mean; });
}

/// Whether the file holds a single pass, which has no name in it.
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

/// The path of a sibling as seen from the folder of the input: "shot_albedo.exr", "../albedo/shot.exr".
std::string path_from_folder_of(const std::string& input, const std::string& sibling) {
  const std::filesystem::path folder = std::filesystem::path(input).parent_path();
  return std::filesystem::path(sibling).lexically_proximate(folder.empty() ? "." : folder).string();
}

/// The name of a sibling's layer. The beauty of a file of several layers keeps the name that it has there, so that its
/// companions are called after it.
std::string layer_name(const std::string& sibling, const std::string& in_file_name, const Layer& beauty) {
  const std::size_t begin = in_file_name.size();
  if (in_file_name.empty() || sibling.size() <= begin || sibling.compare(0, begin, in_file_name) != 0) return sibling;
  return beauty.pass + sibling.substr(begin);
}

/// Whether the layer is a pass that a render may have in a file of several: a feature, or what describes its samples.
bool is_pass_of_render(const Layer& layer) {
  return layer.companion == Companion::Mean && (info_of(layer.role).feature || layer.role == Role::SampleCount) &&
         info_of(layer.role).layer_channels.allow(layer.channels.size());
}

/// Adds the passes that the source lacks from a file of several, and their variances and halves. A file whose name does
/// not say that it holds passes holds a picture of its own if it has a beauty, and nothing of it is taken.
/// Returns the names of the passes.
std::vector<std::string> add_passes(FrameSource& source, const FileOfPasses& of_several, const LayerView& place,
                                    const ReadLimits& limits) {
  FileInfo file;
  try {
    file = describe_file(of_several.path, limits);
  } catch (const Error&) {
    if (of_several.named_so) throw;
    return {};
  }
  const std::vector<Layer> layers = find_layers(file);
  const auto is_beauty = [](const Layer& l) { return l.role == Role::Beauty && l.companion == Companion::Mean; };
  if (!of_several.named_so && std::any_of(layers.begin(), layers.end(), is_beauty)) return {};
  const bool at_one_place = std::all_of(layers.begin(), layers.end(),
                                        [&](const Layer& l) { return place_of(l) == place_of(layers.front()); });
  const auto is_here = [&](const Layer& l) { return at_one_place || place_of(l) == place; };
  std::vector<Role> taken;
  std::vector<std::string> names;
  for (const Layer& layer : layers)
    if (is_pass_of_render(layer) && is_here(layer) && !has_mean(source, layer.role)) {
      if (std::find(taken.begin(), taken.end(), layer.role) == taken.end()) taken.push_back(layer.role);
      names.push_back(layer.pass);
    }
  if (names.empty()) return {};
  source.files.push_back(std::move(file));
  for (Layer layer : layers) {
    if (!is_here(layer) || std::find(taken.begin(), taken.end(), layer.role) == taken.end()) continue;
    rename_layer(layer, layer.pass, place);
    layer.file = static_cast<int>(source.files.size()) - 1;
    source.layers.push_back(std::move(layer));
  }
  return names;
}

}  // namespace

int add_file(FrameSource& source, const std::string& path, Role role, const ReadLimits& limits) {
  source.files.push_back(describe_file(path, limits));
  const std::vector<Layer> layers = find_layers(source.files.back());
  if (layers.empty()) throw Error(ExitCode::BadInput, fmt::format("{}: no channels", path));
  source.layers.push_back(layer_for(layers, role, place_of(source)));
  source.layers.back().file = static_cast<int>(source.files.size()) - 1;
  return static_cast<int>(source.layers.size()) - 1;
}

void rename_layer(Layer& layer, const std::string& pass, const LayerView& place) {
  layer.name = layer.pass = pass;
  layer.view_layer = place.view_layer;
  if (!place.view.empty()) layer.view = place.view;
}

FrameSource open_source(const std::string& path, const ReadLimits& limits, std::vector<std::string>& notes) {
  FrameSource source;
  source.path = path;
  source.files.push_back(describe_file(path, limits));
  source.layers = find_layers(source.files.front());
  const bool bare = is_one_bare_image(source);
  if (!bare && !may_lack_passes(source)) return source;
  FilesOfRender render = find_siblings(path);
  std::vector<SiblingFile>& siblings = render.others;
  siblings.erase(
      std::remove_if(siblings.begin(), siblings.end(),
                     [&](const SiblingFile& sibling) {
                       return (!bare && !lacks(source, sibling.pass)) ||
                              (is_denoised_name(sibling.pass) && is_result(describe_file(sibling.path, limits)));
                     }),
      siblings.end());
  if (siblings.empty() && render.of_several.empty()) return source;
  const std::string& pass = render.pass;
  const Layer before = source.layers.front();
  if (bare && !pass.empty()) source.layers.front().name = source.layers.front().pass = pass;
  const Layer beauty = bare ? source.layers.front() : *picture_layer(source.layers);
  std::vector<std::string> names;
  for (const SiblingFile& sibling : siblings) {
    const auto known = classify_pass(sibling.pass);
    const auto added =
        static_cast<std::size_t>(add_file(source, sibling.path, known ? known->role : Role::Other, limits));
    rename_layer(source.layers[added], layer_name(sibling.pass, pass, beauty), place_of(beauty));
    names.push_back(path_from_folder_of(path, sibling.path));
    if (find_layers(source.files.back()).size() > 1) render.of_several.push_back({sibling.path, true});
  }
  classify_layers(source.files, source.layers);
  for (const FileOfPasses& file : render.of_several)
    if (const std::vector<std::string> passes = add_passes(source, file, place_of(beauty), limits); !passes.empty())
      names.push_back(fmt::format("{} ({})", path_from_folder_of(path, file.path), fmt::join(passes, ", ")));
  if (names.empty()) {
    source.layers.front() = before;
    return source;
  }
  classify_layers(source.files, source.layers);
  notes.push_back(fmt::format("passes from files next to the input: {}", fmt::join(names, ", ")));
  return source;
}

}  // namespace polyrecon
