#include "io/inspect.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "core/halves.h"
#include "core/mean.h"
#include "core/relmse.h"
#include "io/files/channel_reader.h"
#include "io/layers/channel_names.h"
#include "io/observed_read.h"
#include "io/renderers/known_names.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Statistics of a layer while its part is decoded.
struct LayerTally {
  LayerStatistics statistics;
  std::vector<std::size_t> planes;  ///< Indices of the layer's channels in a band.
  std::size_t finite = 0;
  double sum = 0;
};

void add_band(const Band& band, LayerTally& tally) {
  LayerStatistics& s = tally.statistics;
  for (std::size_t i = 0; i < band.pixels; ++i) {
    bool nan = false, infinite = false, negative = false;
    for (const std::size_t plane : tally.planes) {
      const double v = band.samples[plane * band.pixels + i];
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

/// The statistics of all layers. Parts may be added in any order.
class Tallies {
 public:
  void add(const FrameSource& source, int file, int part, const std::vector<std::string>& channels, const Band& band) {
    const auto [found, is_new] = parts_.try_emplace({file, part});
    if (is_new) found->second = begin_part(source, file, part, channels);
    for (LayerTally& tally : found->second) add_band(band, tally);
  }

  /// Decodes the parts that were not added yet.
  void add_other_parts(const FrameSource& source) {
    for (std::size_t f = 0; f < source.files.size(); ++f)
      for (std::size_t p = 0; p < source.files[f].parts.size(); ++p) {
        const int file = static_cast<int>(f), part = static_cast<int>(p);
        if (!source.files[f].parts[p].readable() || parts_.count({file, part}) > 0) continue;
        std::vector<std::string> channels;
        for (const ChannelInfo& channel : source.files[f].parts[p].channels) channels.push_back(channel.name);
        read_bands(source.files[f], part, channels, [&](const Band& band) { add(source, file, part, channels, band); });
      }
  }

  /// By file and part.
  std::vector<LayerStatistics> statistics() const {
    std::vector<LayerStatistics> all;
    for (const auto& [place, tallies] : parts_)
      for (const LayerTally& tally : tallies) {
        all.push_back(tally.statistics);
        if (tally.finite > 0) all.back().mean = tally.sum / static_cast<double>(tally.finite);
      }
    return all;
  }

 private:
  static std::vector<LayerTally> begin_part(const FrameSource& source, int file, int part,
                                            const std::vector<std::string>& channels) {
    std::vector<LayerTally> tallies;
    for (const Layer& layer : source.layers) {
      if (layer.file != file || layer.part != part) continue;
      LayerTally tally;
      tally.statistics.layer = layer.name;
      tally.statistics.pixels =
          source.files[static_cast<std::size_t>(file)].parts[static_cast<std::size_t>(part)].data_window.area();
      for (const std::string& name : layer.channels)
        tally.planes.push_back(
            static_cast<std::size_t>(std::find(channels.begin(), channels.end(), name) - channels.begin()));
      tallies.push_back(std::move(tally));
    }
    return tallies;
  }

  std::map<std::pair<int, int>, std::vector<LayerTally>> parts_;  ///< By file and part.
};

/// Mean of variance / relmse_denominator(mean) over all finite samples; the variance is that of the half buffers where
/// the file holds none. -1 where the noise is unknown.
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

/// Whether a frame has the role, or a file without a beauty has a layer for it.
bool has_role(const Inspection& found, Role role) {
  if (found.frame && role == Role::SampleCount) return !found.frame->sample_count.empty();
  const auto& chosen = found.source.chosen;
  const auto& layers = found.source.layers;
  const auto is_mean = [&](const auto& l) { return l.role == role && l.companion == Companion::Mean; };
  return found.frame ? std::any_of(chosen.begin(), chosen.end(), is_mean)
                     : std::any_of(layers.begin(), layers.end(), is_mean);
}

/// The beauty's name within its view layer; empty in a file without beauty.
std::string beauty_pass(const FrameSource& source) {
  for (const RoleChoice& choice : source.chosen)
    for (const Layer& layer : source.layers)
      if (choice.role == Role::Beauty && layer.companion == Companion::Mean && layer.name == choice.layer)
        return layer.pass;
  return {};
}

/// The roles that denoise has to do without, except those that the renderer has no name for.
std::vector<std::string> missing_roles(const Inspection& found) {
  const std::string beauty = beauty_pass(found.source);
  std::vector<std::string> missing;
  for (const RoleInfo& info : role_table())
    if (info.expected && !has_role(found, info.role) && can_have(beauty, info.role)) missing.emplace_back(info.name);
  if (!found.frame || found.frame->beauty.variance.empty()) missing.emplace_back("variance");
  if (!found.frame || !found.frame->beauty.has_halves()) missing.emplace_back("half buffers");
  return missing;
}

}  // namespace

const LayerStatistics* Inspection::statistics_of(const std::string& layer) const {
  const auto found =
      std::find_if(statistics.begin(), statistics.end(), [&](const LayerStatistics& s) { return s.layer == layer; });
  return found == statistics.end() ? nullptr : &*found;
}

Inspection inspect(const std::string& path, const ReadOptions& options) {
  Inspection result;
  Tallies tallies;
  const auto observe = [&](const FrameSource& source, int file, int part, const std::vector<std::string>& channels,
                           const Band& band) { tallies.add(source, file, part, channels, band); };
  try {
    ReadResult read = read_frame(path, options, observe);
    result.noise_level = noise_level(read.frame.beauty);
    result.samples = mean_samples(read.frame.sample_count);
    result.source = std::move(read.source);
    result.notes = std::move(read.notes);
    result.frame = std::move(read.frame);
  } catch (const Error& problem) {
    if (problem.code() != ExitCode::Missing) throw;
    result.source.path = path;
    result.source.files.push_back(describe_file(path, options.limits));
    result.source.layers = find_layers(result.source.files.front());
    result.notes.emplace_back(problem.what());
  }
  tallies.add_other_parts(result.source);
  result.statistics = tallies.statistics();
  result.missing = missing_roles(result);
  return result;
}

}  // namespace polyrecon
