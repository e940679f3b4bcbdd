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
#include "denoisers/denoise_frame.h"
#include "features/prepare.h"
#include "pipeline/use_prior.h"
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
constexpr int least_crop = 256;  // pixels, each side; the start of a denoiser would count too much on smaller ones
constexpr int pilot_repair_depth = 2;

/// Rank of a tile by its noise: the mean over its pixels of the relative variance of green, each at most 1. The
/// variance is that of the file, else the squared difference of the half buffers, else that of neighbouring pixels. The
/// latter two are larger than the variance by a factor; only the order of the tiles matters.
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

/// About an eighth of the frame, in its middle.
Rect middle_of(const Frame& frame) {
  const auto side = [](int all) {
    return std::min(all, std::max(least_crop, static_cast<int>(all * std::sqrt(pilot_share))));
  };
  const int width = side(frame.width()), height = side(frame.height());
  const int x0 = (frame.width() - width) / 2, y0 = (frame.height() - height) / 2;
  return {x0, y0, x0 + width, y0 + height};
}

/// Seconds that the denoiser's prior adds to each preset: its calls, timed on a part of the frame, and the
/// validation, which reconstructs both halves at about the pilot's preset.
std::array<double, preset_count> time_prior(const Frame& frame, const Denoiser& denoiser, double pilot_seconds,
                                            Progress& progress) {
  const auto all = presets();
  const std::size_t max_bytes = all[pilot_preset].params.max_memory;
  const Rect middle = middle_of(frame);
  const Frame part = crop(frame, middle);
  const double parts = static_cast<double>(frame.width()) * frame.height() / static_cast<double>(middle.area());
  Image noisy = part.beauty.mean;
  repair_nonfinite(noisy, pilot_repair_depth);
  progress.begin("pilot of the denoiser", 2 * Denoiser::units);
  const Stopwatch prefilter;
  const DenoiserFeatures features = denoiser.prefilter(denoiser_features(part), max_bytes, progress);
  const double prefilter_seconds = parts * prefilter.seconds();
  const Stopwatch call;
  denoiser.denoise(noisy, features, max_bytes, progress);
  const double call_seconds = parts * call.seconds();
  progress.end();
  std::array<double, preset_count> seconds{};
  const bool halves = frame.beauty.has_halves();
  for (std::size_t k = 0; k < preset_count; ++k) {
    const DenoiserParams& params = all[k].params.denoiser;
    seconds[k] = call_seconds * static_cast<double>(denoiser_calls(halves, true, params)) +
                 (params.prefilter_features ? prefilter_seconds : 0) + (halves ? 2 * pilot_seconds : 0);
  }
  return seconds;
}

Prediction predict(const Pilot& pilot, std::size_t preset, const std::array<PresetFigures, preset_count>& figures) {
  const double ours = pilot.seconds * figures[preset].seconds / figures[pilot_preset].seconds;
  return {presets()[preset].name, ours + pilot.prior_seconds[preset],
          pilot.relative_mse * figures[preset].error / figures[pilot_preset].error};
}

}  // namespace

Pilot run_pilot(const Frame& frame, Progress& progress, const Denoiser* denoiser) {
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
  if (denoiser) pilot.prior_seconds = time_prior(frame, *denoiser, pilot.seconds, progress);
  pilot.spent = watch.seconds();
  return pilot;
}

double standard_seconds(const Pilot& pilot, const std::array<PresetFigures, preset_count>& figures) {
  return pilot.seconds / figures[pilot_preset].seconds;  // figures are factors of standard's
}

SettingsChoice choose_settings(const Pilot& pilot, const SettingsRequest& request,
                               const std::array<PresetFigures, preset_count>& figures) {
  std::vector<Prediction> all;
  std::vector<CostPoint> points;
  for (std::size_t preset = 0; preset < preset_count; ++preset) {
    all.push_back(predict(pilot, preset, figures));
    points.push_back({all.back().seconds, figures[preset].error});
  }
  const std::vector<std::size_t> front = pareto_front(points);
  assert(!front.empty());
  std::vector<Prediction> predictions;
  for (const std::size_t preset : front) predictions.push_back(all[preset]);
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
