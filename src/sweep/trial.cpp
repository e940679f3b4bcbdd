#include "sweep/trial.h"

#include <algorithm>
#include <utility>

#include "core/cancel_only.h"
#include "core/stopwatch.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {
namespace {

constexpr double enough_seconds = 2;
constexpr std::size_t most_runs = 3;

struct Run {
  double seconds;
  Result result;
};

/// frame: a copy, because reconstruct moves passes out of it.
Run run_once(Frame frame, const Params& params, Progress& progress) {
  const Stopwatch watch;
  Result result = reconstruct(frame, params, progress);
  const double seconds = watch.seconds();
  return {seconds, std::move(result)};
}

}  // namespace

Trial run_trial(const Frame& frame, const Setting& setting, const Reference& reference, Progress& progress) {
  const Frame input = frame_for(frame, setting);
  CancelOnly quiet(progress);
  std::vector<Run> runs;
  for (double spent = 0; spent < enough_seconds && runs.size() < most_runs; spent += runs.back().seconds)
    runs.push_back(run_once(input, setting.params, quiet));
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
  Run& median = runs[runs.size() / 2];
  Trial trial;
  trial.name = setting.name;
  trial.group = setting.group;
  trial.seconds = median.seconds;
  trial.runs = static_cast<int>(runs.size());
  trial.phases = median.result.report.phases;
  trial.score = score(median.result.beauty, reference.mean, reference.variance);
  trial.estimated_relative_mse = median.result.report.estimated_relative_mse;
  trial.beauty = std::move(median.result.beauty);
  return trial;
}

}  // namespace polyrecon
