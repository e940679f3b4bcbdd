#include "io/merge/task.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/rect.h"
#include "io/files/file.h"
#include "io/merge/counts.h"
#include "io/merge/halves.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr double most_single_cover = 0.05;  // share of the picture with one render, beyond which noise is unknown

/// Notes renders that have samples of a part of what the others of their group show.
void note_parts(const MergeTask& task, std::size_t groups, MergeResult& report) {
  std::map<std::size_t, Rect> whole;
  for (const Render& render : task.renders) {
    Rect& rect = whole[render.region.group];
    rect = bounding(rect, render.region.rect);
  }
  const auto parts = std::count_if(task.renders.begin(), task.renders.end(), [&](const Render& render) {
    return !(render.region.rect == whole[render.region.group]);
  });
  if (parts > 0)
    report.notes.push_back(fmt::format(
        "{} of {} renders show a part of {} only and have no samples beyond it, where the others show light", parts,
        task.renders.size(), groups > 1 ? "their region" : "the picture"));
}

void choose_window(MergeTask& task, MergeResult& report) {
  std::map<std::size_t, std::size_t> regions_of_rank;
  std::vector<Rect> rects;
  for (const Render& render : task.renders) {
    task.window = bounding(task.window, render.window);
    ++regions_of_rank[render.region.rank];
    rects.push_back(render.region.rect);
  }
  task.has_regions = std::any_of(rects.begin(), rects.end(), [&](const Rect& r) { return !(r == task.window); });
  const double single = share_of_single_cover(rects);
  const std::size_t groups = regions_of_rank[0], lone_groups = groups - regions_of_rank[1];
  task.joins = report.joined = lone_groups > 0 || single > most_single_cover;
  if (groups > 1) report.notes.push_back(fmt::format("{} regions are joined to one picture", groups));
  note_parts(task, groups, report);
  if (task.joins && lone_groups < groups)
    report.notes.push_back(
        lone_groups > 0
            ? fmt::format("no variance or halves are written, as {} regions have one render only", lone_groups)
            : fmt::format("no variance or halves are written, as {:.0f} % of the picture has one render only",
                          100 * single));
}

Fate fate(const MergeTask& task, std::size_t l) {
  const Layer& layer = task.first().layers[l];
  if (task.renders[1].absent[l]) return Fate::Kept;
  // If each region has one render, its variance and halves describe the picture.
  const bool joined = task.joins && layer.companion != Companion::Mean && info_of(layer.role).values != Values::Count;
  return joined ? Fate::Merged : fate_of(task.first(), layer);
}

void sort_layer(std::size_t l, MergeTask& task, MergeResult& report) {
  const Layer& layer = task.first().layers[l];
  const PartInfo& part = part_of(task.first(), layer);
  if (!part.readable()) {
    report.dropped.push_back(layer.name);
    report.notes.push_back(fmt::format("{} is left out: {} is {}", layer.name,
                                       title_of(file_of(task.first(), layer), layer.part), part.obstacle()));
    return;
  }
  switch (fate(task, l)) {
    case Fate::Merged:
      task.merged.push_back(l);
      for (std::size_t c = 0; c < all_channels(layer).size(); ++c) task.slots.push_back({l, c});
      report.merged.push_back(layer.name);
      break;
    case Fate::Kept:
      task.kept.push_back(l);
      report.kept.push_back(layer.name);
      break;
    case Fate::Dropped:
      report.dropped.push_back(layer.name);
      break;
  }
}

}  // namespace

MergeTask make_task(std::vector<Render> renders, const MergeOptions& options, std::size_t first_b,
                    MergeResult& report) {
  MergeTask task;
  task.renders = std::move(renders);
  task.samples = options.samples;
  choose_window(task, report);
  for (std::size_t l = 0; l < task.first().layers.size(); ++l) sort_layer(l, task, report);
  find_counts(task, report);
  choose_halves(first_b, task, report);
  return task;
}

}  // namespace polyrecon
