#include "io/merge/render.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/layers/channel_names.h"
#include "io/renderers/known_names.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Whether the layer is a depth for compositing next to another one in its view layer. Alone it is merged, as a
/// feature.
bool is_second_depth(const Render& first, const Layer& layer) {
  return info_of(layer.role).empty == EmptyValue::ZeroOrSky && is_compositing_depth(layer.pass) &&
         std::any_of(first.layers.begin(), first.layers.end(), [&](const Layer& other) {
           return other.role == layer.role && other.companion == Companion::Mean && other.rank < layer.rank &&
                  other.view_layer == layer.view_layer && other.view == layer.view;
         });
}

}  // namespace

const std::string& path_of(const Render& render) { return render.files.front().path; }

const FileInfo& file_of(const Render& render, const Layer& layer) {
  return render.files[static_cast<std::size_t>(layer.file)];
}

const PartInfo& part_of(const Render& render, const Layer& layer) {
  return file_of(render, layer).parts[static_cast<std::size_t>(layer.part)];
}

[[noreturn]] void misfit(const Render& render, const Render& first, const std::string& what) {
  throw Error(ExitCode::BadInput, fmt::format("{}: does not fit {}: {}", path_of(render), path_of(first), what));
}

std::vector<std::string> all_channels(const Layer& layer) {
  std::vector<std::string> channels = layer.channels;
  if (!layer.alpha.empty()) channels.push_back(layer.alpha);
  return channels;
}

Fate fate_of(const Render& first, const Layer& layer) {
  const Values values = info_of(layer.role).values;
  if (layer.companion != Companion::Mean || values == Values::Count) return Fate::Dropped;
  if (values == Values::Exact || all_uint(first.files, layer) || is_second_depth(first, layer)) return Fate::Kept;
  return Fate::Merged;
}

}  // namespace polyrecon
