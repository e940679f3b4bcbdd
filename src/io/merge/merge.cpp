#include "polyrecon/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "io/files/file_identity.h"
#include "io/files/single_part.h"
#include "io/merge/area.h"
#include "io/merge/copy_layer.h"
#include "io/merge/counts.h"
#include "io/merge/layer_merger.h"
#include "io/merge/open_renders.h"
#include "io/merge/output.h"
#include "io/merge/task.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr std::size_t sums_at_once = std::size_t{1} << 18;
constexpr int chunk_lines = 32;
constexpr std::size_t copies_of_kept = 3;  // of each sample: in the result, as decoded, and in the decoder's buffers

/// Lines that are merged at once: as many as the sums of sums_at_once samples have, at least one chunk.
int lines_per_band(const MergeTask& task) {
  const std::size_t line = std::max<std::size_t>(1, task.slots.size() * static_cast<std::size_t>(task.window.width()));
  return std::max(chunk_lines,
                  static_cast<int>(std::min<std::size_t>(sums_at_once / line, band_lines)) / chunk_lines * chunk_lines);
}

/// Throws Error{OutOfMemory} if a band, its sums and the decoded chunks of the inputs need more than max_bytes.
void require_memory(const MergeTask& task, std::size_t max_bytes) {
  const auto lines = static_cast<std::size_t>(std::min(task.window.height(), lines_per_band(task)));
  std::size_t bytes = task.slots.size() * LayerMerger::bytes_per_pixel();  // of one pixel
  for (const FileInfo& file : task.first().files)
    for (const PartInfo& part : file.parts) bytes += part.channels.size() * copies_of_kept * sizeof(float);
  if (static_cast<std::size_t>(task.window.width()) * lines > max_bytes / std::max<std::size_t>(bytes, 1))
    throw Error(ExitCode::OutOfMemory, fmt::format("{}: {} lines of {} pixels need more than the limit of {} MB",
                                                   path_of(task.first()), lines, task.window.width(), max_bytes >> 20));
}

/// Writes the sum of the renders' sample counts, and adds it to `samples`.
void write_counts(const std::string& view_layer, const Weights& weights, NativeBand& band, double& samples) {
  NativeChannel& channel = *band.find(count_name(view_layer));
  const std::size_t pixels = channel.samples.size() / sizeof(float);
  for (std::size_t i = 0; i < pixels; ++i) {
    double sum = 0;
    for (const auto& render : weights) sum += render.at(view_layer)[i];
    put(channel, i, sum);
    samples += sum;
  }
}

}  // namespace

MergeResult merge(const std::vector<std::string>& paths, const std::string& target, const MergeOptions& options) {
  std::vector<std::string> all = paths;
  all.insert(all.end(), options.half_b.begin(), options.half_b.end());
  MergeResult report;
  std::vector<Render> renders = open_renders(all, options.limits, report.notes);
  report.files = static_cast<int>(renders.size());
  const MergeTask task = make_task(std::move(renders), options, options.half_b.empty() ? 0 : paths.size(), report);
  require_memory(task, options.limits.max_bytes);
  LayerMerger merger(task);
  double samples = 0;  // of all pixels
  const auto make = [&](NativeBand& band) {
    const Weights weights = read_weights(task, area_of(band));
    merger.merge(weights, band);
    for (const std::size_t layer : task.kept) copy_layer(task, layer, band);
    for (const std::string& view_layer : task.counted) write_counts(view_layer, weights, band, samples);
    for (const Render& render : task.renders)
      for (const FileInfo& file : render.files) require_unchanged(file);
  };
  write_single_part(target, output_header(task, options.encoding, report.notes), make, lines_per_band(task));
  merger.note(report);
  if (!task.counted.empty())
    report.samples = samples / static_cast<double>(task.window.area()) / static_cast<double>(task.counted.size());
  return report;
}

}  // namespace polyrecon
