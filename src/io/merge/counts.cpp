#include "io/merge/counts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/parallel.h"
#include "io/layers/channel_names.h"
#include "io/merge/area.h"
#include "io/merge/shared_samples.h"
#include "io/renderers/known_names.h"

namespace polyrecon {
namespace {

std::optional<double> samples_of(const MergeTask& task, const Render& render, const std::string& view_layer) {
  return task.samples > 0 ? task.samples : samples_in_metadata(render.files.front(), view_layer);
}

/// The sample-count layer of a view layer, -1 without one.
int count_layer(const MergeTask& task, const std::string& view_layer) {
  int best = -1;
  for (std::size_t l = 0; l < task.first().layers.size(); ++l) {
    const Layer& layer = task.first().layers[l];
    if (task.renders[1].absent[l]) continue;
    if (layer.role != Role::SampleCount || layer.view_layer != view_layer || !part_of(task.first(), layer).readable())
      continue;
    if (best < 0 || layer.rank < task.first().layers[static_cast<std::size_t>(best)].rank) best = static_cast<int>(l);
  }
  return best;
}

/// Whether the metadata hold the number of the whole sequence of which the renders are parts.
bool metadata_count_sequence(const MergeTask& task, const std::string& view_layer) {
  const std::vector<SamplesAttribute> attributes = samples_attributes(view_layer);
  return std::any_of(attributes.begin(), attributes.end(), [&](const SamplesAttribute& attribute) {
    return attribute.of_sequence && find_attribute(task.first().files.front().parts.front(), attribute.name) != nullptr;
  });
}

/// A render has no samples beyond its region.
void leave_region(const Render& render, const Rect& area, std::vector<double>& n) {
  std::size_t i = 0;
  for (int y = area.y0; y < area.y1; ++y)
    for (int x = area.x0; x < area.x1; ++x, ++i)
      if (!render.region.rect.contains(x, y)) n[i] = 0;
}

}  // namespace

void find_counts(MergeTask& task, MergeResult& report) {
  std::set<std::string> view_layers;
  for (const std::size_t l : task.merged) view_layers.insert(task.first().layers[l].view_layer);
  for (const std::string& view_layer : view_layers) {
    const int layer = count_layer(task, view_layer);
    const bool fraction = layer >= 0 && is_sample_fraction(task.first().layers[static_cast<std::size_t>(layer)].pass);
    double total = 0;  // of the first render's region
    bool known = true;
    for (const Render& render : task.renders) {
      const auto samples = samples_of(task, render, view_layer);
      known = known && samples.has_value();
      if (render.region.group == task.first().region.group) total += samples.value_or(0);
    }
    if (known) task.metadata_samples[view_layer] = total;
    const FirstSamples first_samples = compare_first_samples(task, view_layer);
    if (known && task.samples <= 0 && metadata_count_sequence(task, view_layer) &&
        first_samples != FirstSamples::Shared)
      report.notes.push_back(
          fmt::format("{}: {:g} samples in all by the metadata; subsets of one sequence have fewer, give --samples",
                      view_layer, total));
    if (known && (layer < 0 || fraction)) note_shared_samples(task, view_layer, total, first_samples, report);
    if (known || (layer >= 0 && !fraction))
      task.counted.push_back(view_layer);
    else if (!task.joins)
      report.notes.push_back(fmt::format("{}: sample counts are unknown, all renders count alike",
                                         view_layer.empty() ? "the image" : view_layer));
  }
}

std::vector<double> read_counts(const MergeTask& task, const Render& render, const std::string& view_layer,
                                const Rect& area) {
  const int l = count_layer(task, view_layer);
  const double metadata = samples_of(task, render, view_layer).value_or(0);
  std::vector<double> n(area.area(), metadata);
  if (l < 0) return n;
  const Layer& layer = render.layers[static_cast<std::size_t>(l)];
  const double scale = is_sample_fraction(layer.pass) ? metadata : 1;
  const std::vector<float> counts = read_area(file_of(render, layer), layer.part, layer.channels, area);
  for (std::size_t i = 0; i < n.size(); ++i) n[i] = std::isfinite(counts[i]) && counts[i] > 0 ? counts[i] * scale : 0;
  return n;
}

std::vector<double> mean_samples(const MergeTask& task, const std::vector<std::size_t>& renders) {
  std::vector<double> means(renders.size(), 1);
  if (task.counted.empty() || renders.size() < 2) return means;
  in_parallel(renders.size(), [&](std::size_t i) {
    const Render& render = task.renders[renders[i]];
    constexpr int lines = 5;
    double sum = 0;
    for (int line = 0; line < lines; ++line) {
      Rect area = render.region.rect;
      area.y0 += (2 * line + 1) * area.height() / (2 * lines);
      area.y1 = area.y0 + 1;
      for (const double n : read_counts(task, render, task.counted.front(), area)) sum += n;
    }
    means[i] = sum / (lines * static_cast<double>(render.region.rect.width()));
  });
  return means;
}

Weights read_weights(const MergeTask& task, const Rect& area) {
  Weights weights(task.renders.size());
  in_parallel(task.renders.size(), [&](std::size_t k) {
    for (const std::string& view_layer : task.counted)
      weights[k][view_layer] = read_counts(task, task.renders[k], view_layer, area);
    if (!task.has_regions) return;
    for (const std::size_t l : task.merged)
      weights[k].try_emplace(task.first().layers[l].view_layer, std::vector<double>(area.area(), 1.0));
    for (auto& [view_layer, n] : weights[k]) leave_region(task.renders[k], area, n);
  });
  return weights;
}

}  // namespace polyrecon
