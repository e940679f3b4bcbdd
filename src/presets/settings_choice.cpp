#include "presets/settings_choice.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "blend/blend_windows.h"
#include "core/crop_frame.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "core/relmse.h"
#include "core/repair.h"
#include "core/stopwatch.h"
#include "features/prepare.h"
#include "polyrecon/reconstruct.h"
#include "presets/pareto.h"

namespace polyrecon {
namespace {

constexpr int tile_size = block_size;    // pixels; one thread works on one block
constexpr double pilot_share = 1.0 / 8;  // of the frame's pixels
constexpr std::size_t least_tiles = 4;   // of a small frame, so that the pilot sees more than one kind of content
constexpr int tiles_per_thread = 8;      // the most, so that the pilot of a large frame stays short
// "draft, stages 2". A preset of one stage would not do: the error that a single stage predicts for itself is about
// three times too high.
constexpr std::size_t pilot_preset = 2;

/// Mean relative variance of a tile's green channel: from the file's variance, else from the half buffers, else from
/// the differences between neighbouring pixels.
double noise_of(const Frame& frame, const Rect& r) {
  const Pass& beauty = frame.beauty;
  double sum = 0;
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const double value = beauty.mean.at(x, y, 1);
      double noise = 0;
      if (!beauty.variance.empty()) {
        noise = beauty.variance.at(x, y, 1);
      } else {
        const double d = beauty.has_halves()
                             ? static_cast<double>(beauty.half_a.at(x, y, 1)) - beauty.half_b.at(x, y, 1)
                             : value - static_cast<double>(beauty.mean.at(std::max(x - 1, r.x0), y, 1));
        noise = d * d;
      }
      const double relative = noise / relmse_denominator(value);
      if (std::isfinite(relative)) sum += std::min(relative, 1.0);
    }
  return sum / static_cast<double>(r.area());
}

/// The tiles with a usable pixel, without narrow ones at the borders where there are others.
std::vector<Rect> usable_tiles(const Frame& frame) {
  std::vector<Rect> tiles = aligned_blocks({0, 0, frame.width(), frame.height()}, tile_size);
  const auto remove = [&](const auto& condition) {
    tiles.erase(std::remove_if(tiles.begin(), tiles.end(), condition), tiles.end());
  };
  remove([&](const Rect& tile) { return !has_usable_pixel(crop(frame.beauty.mean, tile)); });
  std::size_t largest = 0;
  for (const Rect& tile : tiles) largest = std::max(largest, tile.area());
  remove([&](const Rect& tile) { return 2 * tile.area() < largest; });
  return tiles;
}

/// Picks `count` tiles at even ranks of their noise.
std::vector<Rect> choose_tiles(const Frame& frame, std::size_t count) {
  const std::vector<Rect> tiles = usable_tiles(frame);
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t i = 0; i < tiles.size(); ++i) ranked.emplace_back(noise_of(frame, tiles[i]), i);
  std::sort(ranked.begin(), ranked.end());
  count = std::min(count, ranked.size());
  std::vector<Rect> chosen;
  for (std::size_t k = 0; k < count; ++k)
    chosen.push_back(tiles[ranked[(2 * k + 1) * ranked.size() / (2 * count)].second]);
  return chosen;
}

Prediction predict(const Pilot& pilot, std::size_t preset, const std::array<PresetFigures, preset_count>& figures) {
  return {presets()[preset].name, pilot.seconds * figures[preset].seconds / figures[pilot_preset].seconds,
          pilot.relative_mse * figures[preset].error / figures[pilot_preset].error};
}

}  // namespace

Pilot run_pilot(const Frame& frame, Progress& progress) {
  require_usable(frame);
  const auto pixels = static_cast<double>(frame.width()) * frame.height();
  const int threads = processors();
  const auto wanted = static_cast<std::size_t>(pilot_share * pixels / (tile_size * tile_size));
  const std::vector<Rect> tiles = choose_tiles(
      frame, std::clamp<std::size_t>(wanted, least_tiles, static_cast<std::size_t>(tiles_per_thread * threads)));
  std::vector<double> error(tiles.size()), area(tiles.size());
  const Params params = presets()[pilot_preset].params;
  const Stopwatch watch;
  progress.begin("pilot", tiles.size());
  parallel_for(tiles.size(), progress, [&](std::size_t i) {
    Frame part = crop(frame, tiles[i]);
    area[i] = static_cast<double>(tiles[i].area());
    error[i] = area[i] * reconstruct(part, params, silent_progress()).report.estimated_relative_mse;
  });
  progress.end();
  Pilot pilot;
  pilot.spent = watch.seconds();
  const double tried = std::accumulate(area.begin(), area.end(), 0.0);
  pilot.share = tried / pixels;
  pilot.relative_mse = std::accumulate(error.begin(), error.end(), 0.0) / tried;
  // One thread's seconds per pixel, then the frame's seconds on as many threads as its blocks keep busy.
  const double busy = std::min<double>(threads, static_cast<double>(tiles.size()));
  const auto blocks = static_cast<double>(aligned_blocks({0, 0, frame.width(), frame.height()}, block_size).size());
  pilot.seconds = pilot.spent * busy / tried * pixels / std::min<double>(threads, std::max(blocks / block_groups, 1.0));
  return pilot;
}

double standard_seconds(const Pilot& pilot, const std::array<PresetFigures, preset_count>& figures) {
  return pilot.seconds / figures[pilot_preset].seconds;  // figures are factors of standard's
}

SettingsChoice choose_settings(const Pilot& pilot, const SettingsRequest& request,
                               const std::array<PresetFigures, preset_count>& figures) {
  std::vector<CostPoint> points;
  for (const PresetFigures& preset : figures) points.push_back({preset.seconds, preset.error});
  const std::vector<std::size_t> front = pareto_front(points);
  assert(!front.empty());
  std::vector<Prediction> predictions;
  for (const std::size_t preset : front) predictions.push_back(predict(pilot, preset, figures));
  const auto in_time = [&](const Prediction& p) { return !(request.seconds > 0) || p.seconds <= request.seconds; };
  const auto accurate = [&](const Prediction& p) {
    return request.relative_mse > 0 && p.relative_mse <= request.relative_mse;
  };
  std::size_t k = 0;
  while (k + 1 < predictions.size() && in_time(predictions[k + 1]) && !accurate(predictions[k])) ++k;
  SettingsChoice choice;
  choice.preset = front[k];
  choice.chosen = predictions[k];
  if (k + 1 < predictions.size()) choice.next = predictions[k + 1];
  choice.met = in_time(predictions[k]) && (!(request.relative_mse > 0) || accurate(predictions[k]));
  return choice;
}

}  // namespace polyrecon
