#include "io/merge/halves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "io/merge/counts.h"
#include "io/merge/half_split.h"

namespace polyrecon {
namespace {

void note_uneven_halves(const MergeTask& task, const std::array<double, 2>& samples, MergeResult& report) {
  constexpr double noted_ratio = 2;
  if (task.counted.empty() || std::max(samples[0], samples[1]) <= noted_ratio * std::min(samples[0], samples[1]))
    return;
  report.notes.push_back(
      fmt::format("the halves have {:.3g} and {:.3g} samples per pixel, so the estimated error will be too high; merge "
                  "renders of similar length",
                  samples[0], samples[1]));
}

}  // namespace

void choose_halves(std::size_t first_b, MergeTask& task, MergeResult& report) {
  task.half_b.resize(task.renders.size());
  task.halves_weigh_alike = first_b > 0 && !task.joins;
  if (task.joins) {
    if (first_b > 0) report.notes.emplace_back("--half-b has no effect: no halves are written");
    return;
  }
  if (task.halves_weigh_alike) {
    std::fill(task.half_b.begin() + static_cast<std::ptrdiff_t>(first_b), task.half_b.end(), true);
    return;
  }
  for (const Render& region : task.renders) {
    if (region.region.rank > 0) continue;
    std::vector<std::size_t> indices;
    for (std::size_t k = 0; k < task.renders.size(); ++k)
      if (task.renders[k].region.group == region.region.group) indices.push_back(k);
    const std::vector<double> samples = mean_samples(task, indices);
    const std::vector<bool> half_b = split_renders(samples);
    std::array<double, 2> sums{};
    for (std::size_t i = 0; i < indices.size(); ++i) {
      task.half_b[indices[i]] = half_b[i];
      sums[half_b[i] ? 1 : 0] += samples[i];
    }
    note_uneven_halves(task, sums, report);
  }
}

}  // namespace polyrecon
