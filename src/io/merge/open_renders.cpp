#include "io/merge/open_renders.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "io/layers/channel_groups.h"
#include "io/layers/channel_names.h"
#include "io/layers/open_source.h"
#include "io/merge/place_renders.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

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
    // A picture takes the pass in its file's name only if files with other passes are next to it.
    render.files.resize(1);
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

}  // namespace

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

}  // namespace polyrecon
