#include "pipeline/noisy_halves.h"

#include <cstddef>

#include "blend/noise_bound.h"
#include "noise/variance_floor.h"
#include "outliers/remove.h"

namespace polyrecon {
namespace {

std::size_t rows_of(const Frame& frame) { return static_cast<std::size_t>(frame.height()); }

/// A neighbour is not fitted, so it needs neither features nor a bound of its result. The noise of its features matters
/// where that of its beauty is estimated with their help.
Params params_for(HalvesFor purpose, const Frame& frame, Params params) {
  if (purpose != HalvesFor::Neighbour) return params;
  params.steps.features.clear();
  params.steps.prefilter = params.steps.prefilter && !noise_is_measured(frame);
  params.components.noise_bound = false;
  return params;
}

}  // namespace

NoisyHalves make_noisy_halves(Frame& frame, HalvesFor purpose, std::uint64_t stream, const Params& requested,
                              Phases& phases) {
  const Params params = params_for(purpose, frame, requested);
  NoisyHalves out;
  out.survey = phases.run("noise variance", rows_of(frame) * 2 * (1 + frame.features.size()),
                          [&](Progress& progress) { return survey_frame(frame, params.steps, progress); });
  const NoiseVariance& noise = out.survey.noise;
  Preparation& preparation = out.survey.preparation;
  preparation.stream = stream;
  // Before the features are taken from the frame.
  if (purpose != HalvesFor::Fit) out.geometry = geometry_of(frame);
  if (purpose == HalvesFor::FitWithNeighbours) out.surfaces_noise = surface_noise(frame);
  out.prepared = phases.run("features", rows_of(frame) / 4, [&](Progress& progress) {
    return prepare(frame, preparation, noise.variance, params.prefilter, params.reconstruct_alpha, progress);
  });
  HalfPair& pair = out.prepared.pair;
  // The bound is that of the measured variance, before outliers are removed: where an outlier is removed from one half,
  // the other half may still be wrong by this much. An estimated variance is not exact enough for single pixels.
  if (params.components.noise_bound && noise.measured) pair.bound = noise_bound(pair.variance);
  out.outliers = phases.run("fireflies", rows_of(frame) * 2, [&](Progress& progress) {
    const PairNoise known{out.prepared.independent_halves, noise.measured};
    return params.steps.fireflies ? remove_outliers(pair, known, params.outliers, progress) : std::vector<Outlier>();
  });
  // After the removal, so that the variance of an outlier does not spread to its neighbours.
  if (params.components.variance_floor) pair.variance = floor_variance(pair.variance);
  return out;
}

}  // namespace polyrecon
