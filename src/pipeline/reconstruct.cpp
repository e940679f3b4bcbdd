#include "polyrecon/reconstruct.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "blend/levels.h"
#include "blend/noise_bound.h"
#include "blend/prior.h"
#include "blend/select.h"
#include "blend/undershoot.h"
#include "core/color_layout.h"
#include "core/halves.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "features/prepare.h"
#include "maps/error_map.h"
#include "noise/variance.h"
#include "noise/variance_floor.h"
#include "outliers/remove.h"
#include "outliers/restore.h"
#include "pipeline/memory.h"
#include "pipeline/savings.h"
#include "pipeline/stage.h"
#include "temporal/join.h"
#include "temporal/neighbour.h"

namespace polyrecon {
namespace {

constexpr int smallest_level = 16;           // pixels; a smaller level has no window of its own
constexpr double max_restored_gain = 0.001;  // a tenth of the smallest step in brightness that can be seen (Weber)
constexpr double max_total_gain = 0.05;      // more than what the weights' preference for ordinary pixels can lose
constexpr double most_noise_in_prior = 0.9;  // beyond it a prior is the input, which would judge itself

/// Runs a step, tells progress of it, and notes how long it took.
template <typename Step>
auto timed(Report& report, Progress& progress, const std::string& name, std::size_t steps, const Step& step) {
  const auto start = std::chrono::steady_clock::now();
  progress.begin(name, steps);
  auto result = step();
  progress.end();
  report.stages.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
  return result;
}

/// Sections 2.1 and 2.2 of the method on one level and, by way of its remainder, on the coarser ones.
Candidate solve_level(const HalfPair& pair, int level, const Params& params, std::size_t max_bytes,
                      FitCounters& counters, Progress& progress) {
  Candidate result = run_stage(pair, nullptr, params, max_bytes, counters, progress);
  const bool has_coarser = level + 1 < params.levels && std::min(pair.width(), pair.height()) >= 2 * smallest_level;
  Candidate coarse;
  if (has_coarser) {
    coarse = solve_level(downsample(pair), level + 1, params, max_bytes, counters, progress);
    result = add_coarse(pair, std::move(result), coarse, params.selection, max_bytes);
  }
  for (int stage = 2; stage <= params.stages; ++stage) {
    result = run_stage(pair, &result, params, max_bytes, counters, progress);
    if (has_coarser) result = add_coarse(pair, std::move(result), coarse, params.selection, max_bytes);
  }
  return result;
}

/// The average of the halves; pixels without noise keep the input's exact value.
Image average(const HalfPair& pair, const Candidate& solved) {
  Image out = solved.half[0];
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < out.channels(); ++c)
      for (int x = 0; x < out.width(); ++x) {
        const Real a = pair.color[0].at(x, y, c), b = pair.color[1].at(x, y, c);
        bool noisy = a != b;
        for (int k = 0; k < 3; ++k) noisy |= pair.variance.at(x, y, k) > 0;
        out.at(x, y, c) = noisy ? Real(0.5) * (solved.half[0].at(x, y, c) + solved.half[1].at(x, y, c)) : a;
      }
  });
  return out;
}

Image layer_of(const Image& image, int layer) {
  return crop(image, image.bounds(), ColorLayout::first_channel(layer), ColorLayout::primaries);
}

std::array<double, 3> energy_of(const Image& image) {
  const std::vector<double> sums = channel_sums(image);
  const auto pixels = static_cast<double>(image.pixels());
  return {sums[0] / pixels, sums[1] / pixels, sums[2] / pixels};
}

/// Sums of the input's colour channels: beauty, then each AOV.
std::vector<double> color_totals(const Frame& frame) {
  std::vector<double> totals = channel_sums(frame.beauty.mean);
  for (const Pass& aov : frame.aovs)
    for (const double sum : channel_sums(aov.mean)) totals.push_back(sum);
  return totals;
}

void note_fits(const FitCounters& counters, Report& report) {
  report.windows = counters.windows;
  for (std::size_t m = 0; m < report.windows_per_order.size(); ++m) report.windows_per_order[m] = counters.per_model[m];
  report.rank_deficient_windows = counters.rank_deficient;
  report.dropped_windows = counters.dropped;
  report.pixels_fallen_back_to_input = counters.uncovered_pixels;
}

void note_outliers(const std::vector<Outlier>& outliers, const Steps& steps, Report& report) {
  if (!steps.fireflies) {
    report.decisions.push_back({"firefly removal", false, "not asked for"});
    return;
  }
  report.outliers = outliers.size();
  for (const Outlier& outlier : outliers)
    for (std::size_t c = 0; c < 3; ++c) report.outlier_energy[c] += outlier.energy[c];
  report.decisions.push_back(
      {"firefly removal", !outliers.empty(),
       outliers.empty() ? "no pixel stands out alone" : std::to_string(outliers.size()) + " pixels stand out alone"});
}

OutlierParams outlier_params(const NoiseVariance& noise) {
  OutlierParams params;
  params.variance_is_measured = noise.measured;
  return params;
}

void note_neighbours(const JoinCounts& counts, bool with_motion, Report& report) {
  report.neighbours = counts.neighbours;
  report.neighbour_weight = counts.weight;
  report.decisions.push_back(
      {"neighbours in time", counts.neighbours > 0,
       counts.neighbours == 0 ? "none of this size"
                              : std::to_string(counts.neighbours) + (with_motion ? " frames, along the motion vectors"
                                                                                 : " frames, no motion vectors")});
}

/// The denoised layer of the file as a candidate, unless it is none.
Candidate use_prior(Pass pass, const HalfPair& pair, const ErrorMap& error, const SelectParams& params,
                    std::size_t max_bytes, Candidate solved, std::vector<Decision>& decisions) {
  const std::string layer = "layer '" + pass.name;
  Image own = average(pair, solved);
  const CorrectedPrior prior = correct_prior(std::move(pass), pair, own);
  const bool denoised = noise_in_prior(prior.value, pair, own) < most_noise_in_prior;
  own = {};
  decisions.push_back({"prior", denoised, layer + (denoised ? "'" : "' is the noisy image itself")});
  return denoised ? add_prior(pair, prior, error.mse, std::move(solved), params, max_bytes) : solved;
}

/// Progress steps of the fits over all levels and stages: blocks x phases, both halves. Close enough for a bar.
std::size_t fit_steps(const Frame& frame, const Params& params) {
  const std::size_t blocks = aligned_blocks({0, 0, frame.width(), frame.height()}, block_size).size();
  const std::size_t passes =
      1 + static_cast<std::size_t>(params.stages - 1) * (params.guided_bandwidths.empty() ? 1 : 2);
  return blocks * 2 * passes * (params.stride > 1 ? 2 : 1) * 4 / 3;
}

}  // namespace

std::shared_ptr<const Neighbour> prepare_neighbour(const Frame& frame, int number, const Params& params,
                                                   Progress& progress) {
  require_usable(frame);
  const NoiseVariance noise = noise_variance(frame, progress);
  Frame colors;  // the frame in hand has features of its own
  colors.beauty = frame.beauty;
  colors.aovs = frame.aovs;
  colors.alpha = frame.alpha;
  Preparation preparation;
  preparation.stream = 64 * (std::uint64_t{static_cast<std::uint32_t>(number)} + 1);
  Prepared prepared =
      prepare(colors, preparation, noise.variance, params.prefilter, params.reconstruct_alpha, progress);
  if (params.steps.fireflies)
    remove_outliers(prepared.pair, prepared.independent_halves, outlier_params(noise), progress);
  if (params.parts.variance_floor) prepared.pair.variance = floor_variance(prepared.pair.variance);
  return std::make_shared<Neighbour>(Neighbour{std::move(prepared.pair), frame.motion});
}

Result reconstruct(Frame& frame, const Params& params, Progress& progress) {
  return reconstruct(frame, {}, params, progress);
}

Result reconstruct(Frame& frame, const std::vector<TimedNeighbour>& neighbours, const Params& asked,
                   Progress& progress) {
  validate(asked);
  Params params = asked;
  if (!noise_is_measured(frame)) params.patch = params.estimated_patch;
  FrameShape shape = shape_of(frame);
  shape.beside += neighbours_channels(shape, static_cast<int>(neighbours.size()));
  require_memory("layer '" + frame.beauty.name + "'", shape, params);
  Result result;
  Report& report = result.report;
  report.width = frame.width();
  report.height = frame.height();
  report.energy_before = energy_of(frame.beauty.mean);

  require_usable(frame);
  const auto rows = static_cast<std::size_t>(frame.height());
  const NoiseVariance noise = timed(report, progress, "noise variance", rows * 2 * (1 + frame.features.size()), [&] {
    if (params.steps.prefilter) estimate_feature_variance(frame, progress);
    return noise_variance(frame, progress);
  });
  const Preparation preparation = look_at(frame, params.steps);
  report.decisions = preparation.decisions;
  report.variance_source = noise.source;
  Prepared prepared = timed(report, progress, "features", rows / 4, [&] {
    return prepare(frame, preparation, noise.variance, params.prefilter, params.reconstruct_alpha, progress);
  });
  HalfPair& pair = prepared.pair;
  report.repaired_pixels = prepared.repaired_pixels;
  report.negative_pixels = prepared.negative_pixels;
  const std::vector<double> totals = color_totals(frame);
  // Of the noise as it is told: where an outlier goes from one half, the other may still be as wrong as that noise. An
  // estimate knows regions, no single pixels.
  const Image reach = params.parts.noise_bound && noise.measured ? noise_bound(pair.variance) : Image();
  const auto outliers = timed(report, progress, "outliers", rows * 2, [&]() -> std::vector<Outlier> {
    if (!params.steps.fireflies) return {};
    return remove_outliers(pair, prepared.independent_halves, outlier_params(noise), progress);
  });
  if (params.parts.variance_floor)
    pair.variance = floor_variance(pair.variance);  // now: an outlier's variance must not spread to its neighbours
  note_outliers(outliers, params.steps, report);
  if (!neighbours.empty())
    note_neighbours(timed(report, progress, "neighbours in time", 2,
                          [&] { return join_neighbours(frame.motion, neighbours, params.temporal, pair, progress); }),
                    !frame.motion.empty(), report);

  const std::size_t memory = tile_memory(shape, params);
  FitCounters counters;
  Candidate solved = timed(report, progress, "polynomials", fit_steps(frame, params),
                           [&] { return solve_level(pair, 0, params, memory, counters, progress); });
  note_fits(counters, report);
  const double skipped = skipped_share(pair, params);
  report.decisions.push_back(decide_on_pixels(skipped, params));
  estimate_savings(frame, params.prefilter, skipped, report.stages.back().seconds, report.decisions);

  const BoundEnergy bound = timed(report, progress, "noise bound", 1, [&] {
    return reach.empty() ? BoundEnergy() : bind_to_noise(pair, reach, max_total_gain, solved);
  });
  report.bound_pixels = bound.pixels;
  result.error = timed(report, progress, "error map", 1, [&] { return make_error_map(pair, noise.variance, solved); });
  result.order = solved.order;
  if (!frame.prior.mean.empty())
    solved = timed(report, progress, "prior", 1, [&] {
      return use_prior(std::move(frame.prior), pair, result.error, params.selection, memory, std::move(solved),
                       report.decisions);
    });
  Image image = timed(report, progress, "energy", 1, [&] {
    Image out = average(pair, solved);
    if (params.parts.raise_undershoot)
      report.raised_pixels = raise_undershoot(mean_of_halves(pair.color, out.channels()), out);
    restore_energy(outliers, pair.variance, max_restored_gain, out);
    if (bound.pixels > 0) restore_everywhere(bound.energy, pair.variance, max_restored_gain, out);
    if (params.parts.restore_totals)
      report.restored_gain = restore_totals(totals, pair.variance, max_restored_gain, max_total_gain, out);
    return out;
  });
  const ColorLayout layout(image.channels());
  result.beauty = layer_of(image, 0);
  for (int layer = 1; layer < layout.layers(); ++layer) result.aovs.push_back(layer_of(image, layer));
  result.alpha = layout.has_alpha() ? crop(image, image.bounds(), layout.alpha_channel(), 1) : frame.alpha;
  report.energy_after = energy_of(result.beauty);
  report.estimated_relative_mse = result.error.mean_relative_mse;
  return result;
}

}  // namespace polyrecon
