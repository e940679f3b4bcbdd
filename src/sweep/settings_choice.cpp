#include "sweep/settings_choice.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <numeric>

#include "blend/blend_windows.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "core/relmse.h"
#include "polyrecon/reconstruct.h"
#include "sweep/pareto.h"

namespace polyrecon {
namespace {

constexpr int tile_size = block_size;    // worked by one thread: blocks are
constexpr double pilot_share = 1.0 / 8;  // of the frame's pixels
constexpr std::size_t least_tiles = 4;   // of a small frame; fewer say nothing of the rest
constexpr int tiles_per_thread = 8;      // more say little more
// "draft, stages 2": the error that a single stage expects of itself is three times too high.
constexpr std::size_t pilot_step = 2;
constexpr int phases = 4;  // of the blocks that are worked at once (blend/blend_windows.h)

Pass crop(const Pass& pass, const Rect& r) {
  const auto part = [&](const Image& image) { return image.empty() ? Image() : polyrecon::crop(image, r); };
  return {pass.name, part(pass.mean), part(pass.variance), part(pass.half_a), part(pass.half_b)};
}

Frame crop(const Frame& frame, const Rect& r) {
  Frame out;
  out.data_window = r;
  out.beauty = crop(frame.beauty, r);
  for (const Feature& feature : frame.features) out.features.push_back({feature.role, crop(feature.pass, r)});
  for (const Pass& aov : frame.aovs) out.aovs.push_back(crop(aov, r));
  out.prior = crop(frame.prior, r);
  if (!frame.alpha.empty()) out.alpha = polyrecon::crop(frame.alpha, r);
  return out;
}

/// How noisy a tile looks: relative variance where the file tells it, else the difference of neighbours.
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

/// count of the tiles, at even ranks of their noise.
std::vector<Rect> choose_tiles(const Frame& frame, std::size_t count) {
  std::vector<Rect> tiles = aligned_blocks({0, 0, frame.width(), frame.height()}, tile_size);
  std::size_t largest = 0;
  for (const Rect& tile : tiles) largest = std::max(largest, tile.area());
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t i = 0; i < tiles.size(); ++i)
    if (2 * tiles[i].area() >= largest) ranked.emplace_back(noise_of(frame, tiles[i]), i);  // no slivers
  std::sort(ranked.begin(), ranked.end());
  count = std::min(count, ranked.size());
  std::vector<Rect> chosen;
  for (std::size_t k = 0; k < count; ++k)
    chosen.push_back(tiles[ranked[(2 * k + 1) * ranked.size() / (2 * count)].second]);
  return chosen;
}

PlannedStep predict(const Pilot& pilot, std::size_t step, const std::array<StepFigures, step_count>& figures) {
  return {ladder()[step].name, pilot.seconds * figures[step].seconds / figures[pilot_step].seconds,
          pilot.relative_mse * figures[step].error / figures[pilot_step].error};
}

}  // namespace

Pilot run_pilot(const Frame& frame, Progress& progress) {
  const auto pixels = static_cast<double>(frame.width()) * frame.height();
  const int threads = processors();
  const auto wanted = static_cast<std::size_t>(pilot_share * pixels / (tile_size * tile_size));
  const std::vector<Rect> tiles = choose_tiles(
      frame, std::clamp<std::size_t>(wanted, least_tiles, static_cast<std::size_t>(tiles_per_thread * threads)));
  std::vector<double> error(tiles.size()), area(tiles.size());
  const auto start = std::chrono::steady_clock::now();
  progress.begin("pilot", tiles.size());
  parallel_for(tiles.size(), progress, [&](std::size_t i) {
    Frame part = crop(frame, tiles[i]);
    area[i] = static_cast<double>(tiles[i].area());
    error[i] =
        area[i] * reconstruct(part, ladder()[pilot_step].params, silent_progress()).report.estimated_relative_mse;
  });
  progress.end();
  Pilot pilot;
  pilot.spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double tried = std::accumulate(area.begin(), area.end(), 0.0);
  pilot.share = tried / pixels;
  pilot.relative_mse = std::accumulate(error.begin(), error.end(), 0.0) / tried;
  // Seconds of one thread for a pixel, then the frame's on as many threads as its blocks can keep busy.
  const double busy = std::min<double>(threads, static_cast<double>(tiles.size()));
  const auto blocks = static_cast<double>(aligned_blocks({0, 0, frame.width(), frame.height()}, block_size).size());
  pilot.seconds = pilot.spent * busy / tried * pixels / std::min<double>(threads, std::max(blocks / phases, 1.0));
  return pilot;
}

double standard_seconds(const Pilot& pilot, const std::array<StepFigures, step_count>& figures) {
  return pilot.seconds / figures[pilot_step].seconds;  // the figures are over those of standard
}

Plan make_plan(const Pilot& pilot, const PlanRequest& request, const std::array<StepFigures, step_count>& figures) {
  std::vector<CostPoint> points;
  for (const StepFigures& step : figures) points.push_back({step.seconds, step.error});
  std::vector<PlannedStep> steps;
  std::vector<std::size_t> index = pareto_front(points);
  assert(!index.empty());
  for (const std::size_t i : index) steps.push_back(predict(pilot, i, figures));
  const auto in_time = [&](const PlannedStep& s) { return !(request.seconds > 0) || s.seconds <= request.seconds; };
  const auto good = [&](const PlannedStep& s) {
    return request.relative_mse > 0 && s.relative_mse <= request.relative_mse;
  };
  std::size_t chosen = 0;
  while (chosen + 1 < steps.size() && in_time(steps[chosen + 1]) && !good(steps[chosen])) ++chosen;
  Plan plan;
  plan.params = ladder()[index[chosen]].params;
  plan.step = steps[chosen];
  if (chosen + 1 < steps.size()) plan.next = steps[chosen + 1];
  plan.met = in_time(steps[chosen]) && (!(request.relative_mse > 0) || good(steps[chosen]));
  return plan;
}

}  // namespace polyrecon
