#include "io/merge/shared_samples.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/files/channel_reader.h"
#include "io/layers/channel_names.h"
#include "io/renderers/known_names.h"

namespace polyrecon {
namespace {

/// Samples of a render over the number of the other renders, up to which a sample that all have in common matters: with
/// 4 renders of 16 samples the error of a textured plane is 1.4 times what their variance says.
constexpr double longest_shared = 8;
constexpr int probed_lines = 32;

bool hits_something(const Render& render, std::size_t l) {
  const Layer& layer = render.layers[l];
  if (!part_of(render, layer).readable()) return false;
  const Rect& window = part_of(render, layer).data_window;
  const int y0 = std::max(window.y0, (window.y0 + window.y1 - probed_lines) / 2);
  ChannelReader reader(file_of(render, layer), layer.part, layer.channels);
  const std::vector<float>& depth = reader.read(y0, std::min(window.y1, y0 + probed_lines));
  return std::any_of(depth.begin(), depth.end(), [](float z) { return z < sky_depth(); });
}

}  // namespace

FirstSamples compare_first_samples(const MergeTask& task, const std::string& view_layer) {
  for (std::size_t l = 0; l < task.first().layers.size(); ++l) {
    const Layer& layer = task.first().layers[l];
    if (!is_compositing_depth(layer.pass) || layer.view_layer != view_layer || task.renders[1].absent[l]) continue;
    const bool a = hits_something(task.renders[0], l), b = hits_something(task.renders[1], l);
    if (a || b) return a && b ? FirstSamples::Shared : FirstSamples::Apart;
  }
  return FirstSamples::Unknown;
}

void note_shared_samples(MergeTask& task, const std::string& view_layer, double samples, FirstSamples first_samples,
                         MergeResult& report) {
  const auto others = static_cast<double>(task.renders.size() - 1);
  const double each = samples / static_cast<double>(task.renders.size());
  const FileInfo& file = task.first().files.front();
  const std::vector<std::string> names = attributes_of_central_samples(view_layer);
  const bool central = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return find_attribute(file.parts.front(), name) != nullptr;
  });
  const bool subsets = task.samples > 0 && task.samples < samples_in_metadata(file, view_layer).value_or(0);
  if (!central || subsets || task.has_regions || each > longest_shared * others) return;
  if (first_samples == FirstSamples::Apart) return;
  task.shared_samples = fmt::format(
      "{}: {}the first of the {:g} samples of each of the {} renders lies at the pixel's centre, so their "
      "errors are alike at edges and textures, where the variance is too low; fewer and longer renders "
      "have less error, subsets of one sequence the least",
      view_layer, first_samples == FirstSamples::Shared ? "" : "if the renders differ in their seed, ", each,
      task.renders.size());
  report.notes.push_back(task.shared_samples);
}

}  // namespace polyrecon
