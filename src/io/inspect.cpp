#include "io/inspect.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/halves.h"
#include "core/relmse.h"
#include "io/channel_names.h"
#include "io/channel_reader.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Statistics of one layer while the bands of its part go by.
struct LayerTally {
  LayerStatistics statistics;
  std::vector<std::size_t> planes;  ///< Of the part's channels.
  std::size_t finite = 0;
  double sum = 0;
};

void add_band(const std::vector<float>& band, std::size_t pixels, LayerTally& tally) {
  LayerStatistics& s = tally.statistics;
  for (std::size_t i = 0; i < pixels; ++i) {
    bool nan = false, infinite = false, negative = false;
    for (const std::size_t plane : tally.planes) {
      const double v = band[plane * pixels + i];
      nan = nan || std::isnan(v);
      infinite = infinite || std::isinf(v);
      negative = negative || v < 0;
      if (!std::isfinite(v)) continue;
      s.minimum = tally.finite == 0 ? v : std::min(s.minimum, v);
      s.maximum = tally.finite == 0 ? v : std::max(s.maximum, v);
      tally.sum += v;
      ++tally.finite;
    }
    s.nan += nan;
    s.infinite += infinite;
    s.negative += negative;
  }
}

/// Layers of one part, which is decoded once.
std::vector<LayerTally> tally_part(const FileInfo& file, int part, const std::vector<const Layer*>& layers) {
  const PartInfo& info = file.parts[static_cast<std::size_t>(part)];
  const Rect window = info.data_window;
  std::vector<std::string> channels;
  for (const ChannelInfo& channel : info.channels) channels.push_back(channel.name);
  std::vector<LayerTally> tallies;
  for (const Layer* layer : layers) {
    LayerTally tally;
    tally.statistics.layer = layer->name;
    tally.statistics.pixels = window.area();
    for (const std::string& name : layer->channels)
      tally.planes.push_back(
          static_cast<std::size_t>(std::find(channels.begin(), channels.end(), name) - channels.begin()));
    tallies.push_back(std::move(tally));
  }
  ChannelReader reader(file, part, channels);
  const int lines = reader.lines_per_band();
  for (int y = window.y0; y < window.y1; y += std::min(lines, window.y1 - y)) {
    const int end = y + std::min(lines, window.y1 - y);
    const std::size_t pixels = static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(end - y);
    const std::vector<float>& band = reader.read(y, end);
    for (LayerTally& tally : tallies) add_band(band, pixels, tally);
  }
  for (LayerTally& tally : tallies)
    if (tally.finite > 0) tally.statistics.mean = tally.sum / static_cast<double>(tally.finite);
  return tallies;
}

std::vector<LayerStatistics> statistics_of(const FrameSource& source) {
  std::vector<LayerStatistics> statistics;
  for (std::size_t f = 0; f < source.files.size(); ++f)
    for (std::size_t p = 0; p < source.files[f].parts.size(); ++p) {
      if (!source.files[f].parts[p].readable()) continue;
      std::vector<const Layer*> layers;
      for (const Layer& layer : source.layers)
        if (layer.file == static_cast<int>(f) && layer.part == static_cast<int>(p)) layers.push_back(&layer);
      for (LayerTally& tally : tally_part(source.files[f], static_cast<int>(p), layers))
        statistics.push_back(std::move(tally.statistics));
    }
  return statistics;
}

/// Mean of variance / relmse_denominator(mean) over all finite samples; the variance is that of the half buffers where
/// the file holds none. -1 where the file tells no noise.
double noise_level(const Pass& beauty) {
  if (beauty.variance.empty() && !beauty.has_halves()) return -1;
  double sum = 0;
  std::size_t count = 0;
  for (int c = 0; c < beauty.mean.channels(); ++c)
    for (std::size_t i = 0; i < beauty.mean.pixels(); ++i) {
      const double mean = beauty.mean.plane(c)[i];
      const double variance = beauty.variance.empty()
                                  ? variance_of_mean<double>(beauty.half_a.plane(c)[i], beauty.half_b.plane(c)[i])
                                  : static_cast<double>(beauty.variance.plane(c)[i]);
      const double relative = variance / relmse_denominator(mean);
      if (!std::isfinite(relative)) continue;
      sum += relative;
      ++count;
    }
  return count == 0 ? -1 : sum / static_cast<double>(count);
}

bool is_chosen(const FrameSource& source, Role role, bool (*wanted)(Companion)) {
  return std::any_of(source.chosen.begin(), source.chosen.end(),
                     [&](const RoleChoice& c) { return c.role == role && wanted(c.companion); });
}

std::vector<std::string> missing_roles(const FrameSource& source) {
  const auto mean = [](Companion c) { return c == Companion::Mean; };
  std::vector<std::string> missing;
  for (const RoleInfo& info : role_table())
    if (info.expected && !is_chosen(source, info.role, mean)) missing.emplace_back(info.name);
  if (!is_chosen(source, Role::Beauty, is_variance)) missing.emplace_back("variance");
  if (!is_chosen(source, Role::Beauty, is_half)) missing.emplace_back("half buffers");
  return missing;
}

double samples_of(const ReadResult& read, const ReadOptions& options) {
  const Image& counts = read.frame.sample_count;
  if (counts.empty()) {
    if (options.samples > 0) return options.samples;
    return samples_in_metadata(read.source.files.front(), read.source.view_layer).value_or(0);
  }
  double sum = 0;
  for (std::size_t i = 0; i < counts.pixels(); ++i) sum += counts.plane(0)[i];
  return sum / static_cast<double>(counts.pixels());
}

}  // namespace

Inspection inspect(const std::string& path, const ReadOptions& options) {
  Inspection result;
  try {
    ReadResult read = read_frame(path, options);
    result.noise_level = noise_level(read.frame.beauty);
    result.samples = samples_of(read, options);
    result.source = std::move(read.source);
    result.notes = std::move(read.notes);
  } catch (const Error& problem) {
    if (problem.code() != ExitCode::Missing) throw;
    result.source.path = path;
    result.source.files.push_back(describe_file(path, options.limits));
    result.source.layers = find_layers(result.source.files.front());
    result.notes.emplace_back(problem.what());
  }
  result.statistics = statistics_of(result.source);
  result.missing = missing_roles(result.source);
  return result;
}

}  // namespace polyrecon
