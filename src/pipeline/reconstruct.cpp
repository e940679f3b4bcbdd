#include "polyrecon/reconstruct.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "blend/undershoot.h"
#include "core/color_layout.h"
#include "core/halves.h"
#include "core/lamps.h"
#include "core/mask.h"
#include "core/mean.h"
#include "core/parallel.h"
#include "core/rect.h"
#include "core/repair.h"
#include "core/void_pixels.h"
#include "core/wrap.h"
#include "features/prepare.h"
#include "maps/error_map.h"
#include "noise/variance.h"
#include "outliers/restore.h"
#include "pipeline/denoised_alpha.h"
#include "pipeline/memory.h"
#include "pipeline/noisy_halves.h"
#include "pipeline/notes.h"
#include "pipeline/phases.h"
#include "pipeline/result_images.h"
#include "pipeline/savings.h"
#include "pipeline/solve.h"
#include "pipeline/stage.h"
#include "pipeline/use_prior.h"
#include "polyrecon/error.h"
#include "temporal/join.h"
#include "temporal/neighbour.h"

// The order of the steps of a reconstruction. Those before the fit are in pipeline/noisy_halves.cpp, which neighbours
// in time share.
namespace polyrecon {
namespace {

constexpr double gross_excess = 2;           // times the noise bound: ten standard deviations
constexpr double max_restored_gain = 0.001;  // a tenth of the least visible step in brightness (Weber)
constexpr double max_total_gain = 0.05;      // above what is lost because weights favour ordinary pixels
constexpr double most_energy_change = 0.5;   // share of the input's; fireflies and negative values cost less

/// The parameters for a frame: an estimated noise variance needs other patches than a measured one.
Params params_for_frame(const Frame& frame, Params params) {
  validate(params);
  if (!noise_is_measured(frame)) params.patch = params.estimated_patch;
  return params;
}

/// Averages the neighbours into the halves, and frees what only that needs.
void join(const std::vector<TimedNeighbour>& neighbours, bool with_motion, const TemporalParams& params,
          NoisyHalves& halves, Phases& phases, Report& report) {
  const JoinCounts joined = phases.run("neighbours in time", 2, [&](Progress& progress) {
    return join_neighbours(halves.geometry, halves.surfaces_noise, neighbours, params, halves.prepared.pair, progress);
  });
  halves.geometry = {};
  halves.surfaces_noise = {};
  note_neighbours(joined, with_motion, report);
}

Candidate fit_polynomials(const Frame& frame, const HalfPair& pair, const Params& params, std::size_t max_bytes,
                          Phases& phases, Report& report) {
  FitCounters counters;
  Candidate result = phases.run(fit_phase, fit_units(pair, params),
                                [&](Progress& progress) { return solve(pair, params, max_bytes, counters, progress); });
  note_fits(counters, report);
  const double skipped = skipped_share(pair, params);
  report.decisions.push_back(decide_on_pixels(skipped, params));
  estimate_savings(frame, params.prefilter, skipped, report.phases.back().seconds, report.decisions);
  return result;
}

/// Ends changes at gross_excess times the noise bound, in all layers alike so that those that add up to the beauty
/// still do: if every window contradicts a pixel grossly, none of them is right there.
void end_gross_changes(const HalfPair& pair, Image& image) {
  if (pair.bound.empty()) return;
  const auto input = [&](int c, std::size_t i) {
    return Real(0.5) * (pair.color[0].plane(c)[i] + pair.color[1].plane(c)[i]);
  };
  for_rows(image.height(), [&](int y) {
    for (int x = 0; x < image.width(); ++x) {
      const std::size_t i = image.index(x, y);
      double squared = 0;
      for (int c = 0; c < ColorLayout::primaries; ++c) {
        const auto change = static_cast<double>(image.plane(c)[i] - input(c, i));
        squared += change * change;
      }
      const double most = gross_excess * gross_excess * static_cast<double>(pair.bound.plane(0)[i]);
      if (!(squared > most)) continue;
      const auto kept = static_cast<Real>(std::sqrt(most / squared));
      for (int c = 0; c < image.channels(); ++c)
        image.plane(c)[i] = input(c, i) + kept * (image.plane(c)[i] - input(c, i));
    }
  });
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
        noisy &= pair.bound.empty() || pair.bound.at(x, y, 0) > 0;
        out.at(x, y, c) =
            noisy ? Real(0.5) * (solved.half[0].at(x, y, c) + solved.half[1].at(x, y, c)) : Real(0.5) * (a + b);
      }
  });
  end_gross_changes(pair, out);
  return out;
}

/// The sums that the colour channels of the result are to have, beauty first, then each AOV: those of the input. In
/// pixels that are not usable there, what the repair has put in counts, else it would be taken from all other pixels.
std::vector<double> color_totals(const Frame& frame, const Image& result) {
  std::vector<double> totals;
  const auto add = [&](const Pass& pass) {
    for (int c = 0; c < pass.mean.channels(); ++c) {
      const auto channel = static_cast<int>(totals.size());
      totals.push_back(ordered_sum(static_cast<std::size_t>(result.height()), [&](std::size_t y) {
        const Real *in = pass.mean.row(c, static_cast<int>(y)), *out = result.row(channel, static_cast<int>(y));
        double row = 0;
        for (int x = 0; x < result.width(); ++x) row += static_cast<double>(usable(in[x]) ? in[x] : out[x]);
        return row;
      }));
    }
  };
  add(frame.beauty);
  for (const Pass& aov : frame.aovs) add(aov);
  return totals;
}

/// Averages the halves of the result and returns to it the energy that outliers and the fits took.
Image restore(const Frame& frame, const NoisyHalves& halves, const Candidate& solved, const Params& params,
              Report& report) {
  const HalfPair& pair = halves.prepared.pair;
  Image out = average(pair, solved);
  if (params.components.raise_undershoot)
    report.pixels_raised_to_input = raise_undershoot(mean_of_halves(pair.color, out.channels()), out);
  restore_energy(halves.outliers, pair.variance, max_restored_gain, out);
  if (params.components.restore_totals)
    report.restored_gain =
        restore_totals(color_totals(frame, out), pair.variance, max_restored_gain, max_total_gain, out);
  return out;
}

/// Distributes the channels of the finished image to the layers of the result.
void put_layers(const Image& image, Result& result) {
  const ColorLayout layout(image.channels());
  const auto layer_of = [&](int layer) {
    return crop(image, image.bounds(), ColorLayout::first_channel(layer), ColorLayout::primaries);
  };
  result.beauty = layer_of(0);
  for (int layer = 1; layer < layout.layers(); ++layer) result.aovs.push_back(layer_of(layer));
  if (layout.has_alpha()) result.alpha = crop(image, image.bounds(), layout.alpha_channel(), 1);
}

/// The change of each channel's sum over the pixels that are usable in the input, relative to the input's energy there.
/// Throws where that is too much.
std::array<double, 3> require_energy(const Pass& beauty, const Image& result) {
  std::array<double, 3> changes{};
  for (int c = 0; c < beauty.mean.channels(); ++c) {
    const auto sum = [&](const auto& term) {
      return ordered_sum(static_cast<std::size_t>(result.height()), [&](std::size_t y) {
        double row = 0;
        for (int x = 0; x < result.width(); ++x)
          if (const Real in = beauty.mean.at(x, static_cast<int>(y), c); usable(in))
            row += term(static_cast<double>(in), static_cast<double>(result.at(x, static_cast<int>(y), c)));
        return row;
      });
    };
    const double energy = sum([](double in, double) { return std::abs(in); });
    const double change = sum([](double in, double out) { return out - in; });
    if (std::abs(change) > most_energy_change * energy)
      throw Error(
          ExitCode::CheckFailed,
          fmt::format("layer '{}', channel {}: the result would change the energy by {:+.0f} % (limit {:.0f} %): "
                      "its halves, variance or features are not those of this picture; render them again, or "
                      "leave them out",
                      beauty.name, c, 100 * change / energy, 100 * most_energy_change));
    if (energy > 0) changes[static_cast<std::size_t>(c)] = change / energy;
  }
  return changes;
}

/// Reconstructs a panorama with columns of its other end beyond both ends, and takes them away again.
Result reconstruct_panorama(Frame& frame, const std::vector<TimedNeighbour>& neighbours, const Params& params,
                            Progress& progress, const Denoiser* denoiser) {
  Report report;
  note_input(frame, report);
  wrap(frame);
  Result result = reconstruct(frame, neighbours, params, progress, denoiser);
  const auto unwrap = [](Image& image) { image = unwrapped(image); };
  for_images(result, unwrap);
  unwrap(frame.alpha);
  unwrap(frame.sample_count);
  frame.wraps = true;
  result.error.mean_relative_mse = mean_of(result.error.relative_mse);
  result.report.width = report.width;
  result.report.energy_before = report.energy_before;
  note_result(result);
  return result;
}

}  // namespace

std::shared_ptr<const Neighbour> prepare_neighbour(Frame frame, int number, const Params& params, Progress& progress) {
  if (frame.wraps) wrap(frame);
  Report not_kept;
  Phases phases(progress, not_kept);
  const std::uint64_t stream = streams_per_frame * (std::uint64_t{static_cast<std::uint32_t>(number)} + 1);
  NoisyHalves halves = make_noisy_halves(frame, HalvesFor::Neighbour, stream, params, phases);
  return std::make_shared<Neighbour>(Neighbour{std::move(halves.prepared.pair), std::move(halves.geometry)});
}

Result reconstruct(Frame& frame, const Params& params, Progress& progress) {
  return reconstruct(frame, {}, params, progress);
}

Result reconstruct(Frame& frame, const std::vector<TimedNeighbour>& neighbours, const Params& requested,
                   Progress& progress, const Denoiser* denoiser) {
  if (frame.wraps) return reconstruct_panorama(frame, neighbours, requested, progress, denoiser);
  const Params params = params_for_frame(frame, requested);
  if (denoiser) frame.prior = {};
  FrameShape shape = shape_of(frame);
  if (denoiser) add_denoiser(shape);
  shape.other_channels += neighbours_channels(shape, static_cast<int>(neighbours.size()), params);
  require_memory("layer '" + frame.beauty.name + "'", shape, params);
  Result result;
  Report& report = result.report;
  Phases phases(progress, report);
  note_input(frame, report);

  // The input as two halves of known noise, and the features that describe the scene (equations 1 and 2).
  DenoiserFeatures features = denoiser ? denoiser_features(frame) : DenoiserFeatures();
  NoisyHalves halves =
      make_noisy_halves(frame, neighbours.empty() ? HalvesFor::Fit : HalvesFor::FitWithNeighbours, 0, params, phases);
  HalfPair& pair = halves.prepared.pair;
  note_preparation(halves.survey, halves.prepared, report);
  note_outliers(halves.outliers, params.steps, report);
  if (!neighbours.empty()) join(neighbours, !frame.motion.empty(), params.temporal, halves, phases, report);

  if (denoiser)
    frame.prior = phases.run("denoiser", make_prior_units(halves.prepared, params.denoiser), [&](Progress& p) {
      return make_prior(*denoiser, std::move(features), halves.survey.preparation.features, halves.prepared,
                        params.denoiser, denoiser_memory(shape, params), p);
    });
  const std::size_t max_bytes = tile_memory(shape, params);
  ReadyPrior prior = ready_prior(std::move(frame.prior), denoiser != nullptr, halves.prepared);
  if (prior.validated)
    prior.validation = phases.run("validation of the prior", validation_units(pair, params),
                                  [&](Progress& p) { return make_validation(prior.pass, pair, params, max_bytes, p); });

  // Polynomials around every centre, of the order with the least estimated error, blended (equations 3 to 9).
  Candidate solved = fit_polynomials(frame, pair, params, max_bytes, phases, report);

  // Void pixels stay empty; lamps get their values at the end.
  const Lamps& lamps = halves.survey.preparation.lamps;
  const Image fitted = both_masks(halves.survey.preparation.rendered, lamps.others);
  empty_void(fitted, pair, solved);

  // The estimate of the error that is left, and the prior where its error is smaller.
  result.error = phases.run(
      "error map", 1, [&](Progress&) { return make_error_map(pair, halves.survey.noise.variance, solved, fitted); });
  result.order = solved.order;
  Image ours;  // all layers without the prior, which the colour layers add up to
  if (!prior.pass.mean.empty()) {
    if (!frame.aovs.empty()) ours = restore(frame, halves, solved, params, report);
    solved = phases.run("prior", 1, [&](Progress&) {
      const Image reconstruction = average(pair, solved);
      return use_prior(std::move(prior), pair, reconstruction, params.selection, max_bytes, std::move(solved),
                       result.error, report.decisions);
    });
  }

  // The image, with the energy of the input (equations 10 and 11).
  Image image = phases.run("energy", 1, [&](Progress&) { return restore(frame, halves, solved, params, report); });
  if (!ours.empty()) image = follow_beauty(std::move(ours), image);
  put_lamps(lamps, frame, image);
  put_errors(lamps, image, result.error);
  report.energy_change = require_energy(frame.beauty, image);
  put_layers(image, result);
  result.alpha = result.alpha.empty() ? frame.alpha : phases.run("alpha", 1, [&](Progress& p) {
    const Preparation& prepared = halves.survey.preparation;
    return denoised_alpha(frame, std::move(result.alpha), prepared.sampled, prepared.noise_correlation, p);
  });
  note_result(result);
  return result;
}

}  // namespace polyrecon
