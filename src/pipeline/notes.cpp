#include "pipeline/notes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "core/repair.h"
#include "outliers/restore.h"

namespace polyrecon {
namespace {

/// Mean of each channel of the beauty over its usable pixels.
std::array<double, 3> energy_of(const Image& beauty) {
  const std::vector<double> sums = channel_sums(beauty);
  std::array<double, 3> means{};
  for (std::size_t c = 0; c < means.size(); ++c) {
    const Real* plane = beauty.plane(static_cast<int>(c));
    const auto pixels = std::count_if(plane, plane + beauty.pixels(), usable);
    if (pixels > 0) means[c] = sums[c] / static_cast<double>(pixels);
  }
  return means;
}

}  // namespace

void note_input(const Frame& frame, Report& report) {
  report.width = frame.width();
  report.height = frame.height();
  report.energy_before = energy_of(frame.beauty.mean);
}

void note_preparation(const Survey& survey, const Prepared& prepared, Report& report) {
  report.variance_source = survey.noise.source;
  report.decisions = survey.preparation.decisions;
  report.repaired_pixels = prepared.repaired_pixels;
  report.negative_pixels = prepared.negative_pixels;
}

void note_outliers(const std::vector<Outlier>& outliers, const Steps& steps, Report& report) {
  if (!steps.fireflies) {
    report.decisions.push_back({"firefly removal", false, "not requested"});
    return;
  }
  report.outliers = outliers.size();
  for (const Outlier& outlier : outliers)
    for (std::size_t c = 0; c < 3; ++c) report.outlier_energy[c] += outlier.energy[c];
  report.decisions.push_back(
      {"firefly removal", !outliers.empty(),
       outliers.empty() ? "no pixel stands out alone" : std::to_string(outliers.size()) + " pixels stand out alone"});
}

void note_neighbours(const JoinCounts& counts, bool with_motion, Report& report) {
  report.neighbours = counts.neighbours;
  report.neighbour_weight = counts.weight;
  report.neighbour_shared_noise = counts.shared_noise;
  report.decisions.push_back(
      {"neighbours in time", counts.neighbours > 0,
       counts.neighbours == 0 ? "none with these layers"
                              : std::to_string(counts.neighbours) + (with_motion ? " frames, along the motion vectors"
                                                                                 : " frames, no motion vectors")});
}

void note_fits(const FitCounters& counters, Report& report) {
  report.windows = counters.windows;
  for (std::size_t m = 0; m < report.windows_per_order.size(); ++m) report.windows_per_order[m] = counters.per_model[m];
  report.rank_deficient_windows = counters.rank_deficient;
  report.windows_not_finite = counters.dropped;
  report.pixels_kept_noisy = counters.uncovered_pixels;
}

void note_result(Result& result) {
  result.report.energy_after = energy_of(result.beauty);
  result.report.estimated_relative_mse = result.error.mean_relative_mse;
}

}  // namespace polyrecon
