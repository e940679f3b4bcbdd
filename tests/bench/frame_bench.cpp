#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "bench/synthetic.h"
#include "blend/blend_windows.h"
#include "blend/select.h"
#include "core/gaussian.h"
#include "features/prefilter.h"
#include "pipeline/stage.h"
#include "polyrecon/params.h"

namespace polyrecon::bench {
namespace {

constexpr int side = 256;

void count_pixels(benchmark::State& state) {
  state.SetLabel("items are pixels");
  state.SetItemsProcessed(state.iterations() * side * side);
}

/// Stage 1 of one half. Argument: the quality.
void fit_and_blend_frame(benchmark::State& state) {
  const Params params = params_for(static_cast<Quality>(state.range(0)));
  const HalfPair pair = synthetic_pair(side, side);
  const FitSource source{&pair.color[0], &pair.variance, &pair.features[1], &pair.color[1],
                         &pair.variance, nullptr,        pair.epsilon};
  const std::vector<unsigned char> active(pair.variance.pixels(), 1);
  FitCounters counters;
  for ([[maybe_unused]] const auto pass : state)
    benchmark::DoNotOptimize(
        fit_and_blend(source, active, fit_params(params, params.first_bandwidths), counters, silent_progress()));
  state.counters["windows/s"] = benchmark::Counter(static_cast<double>(counters.windows), benchmark::Counter::kIsRate);
  count_pixels(state);
}
BENCHMARK(fit_and_blend_frame)
    ->ArgName("quality")
    ->Arg(static_cast<int>(Quality::Draft))
    ->Arg(static_cast<int>(Quality::Standard))
    ->Arg(static_cast<int>(Quality::Best))
    ->Unit(benchmark::kMillisecond);

void prefilter_frame(benchmark::State& state) {
  const PrefilterParams params = params_for(static_cast<Quality>(state.range(0))).prefilter;
  const HalfPair pair = synthetic_pair(side, side);
  for ([[maybe_unused]] const auto pass : state)
    benchmark::DoNotOptimize(prefilter(pair.color, pair.variance, params, silent_progress()));
  count_pixels(state);
}
BENCHMARK(prefilter_frame)
    ->ArgName("quality")
    ->Arg(static_cast<int>(Quality::Draft))
    ->Arg(static_cast<int>(Quality::Standard))
    ->Unit(benchmark::kMillisecond);

/// Argument: the number of candidates.
void select_frame(benchmark::State& state) {
  const HalfPair pair = synthetic_pair(side, side);
  std::vector<Candidate> candidates;
  for (int k = 0; k < state.range(0); ++k) {
    const double sigma = 0.5 * (k + 1);  // blurs of different widths, none of which is best everywhere
    candidates.push_back({{gaussian_blur(pair.color[0], sigma), gaussian_blur(pair.color[1], sigma)},
                          pair.variance,
                          pair.variance,
                          Image(side, side, 1)});
  }
  const Image brightness = gaussian_blur(pair.color[0], 2);
  for ([[maybe_unused]] const auto pass : state)
    benchmark::DoNotOptimize(select(pair, brightness, candidates, SelectParams()));
  count_pixels(state);
}
BENCHMARK(select_frame)->ArgName("candidates")->Arg(2)->Arg(4)->Unit(benchmark::kMillisecond);

/// Three channels. Argument: ten times the standard deviation.
void gaussian_blur_frame(benchmark::State& state) {
  const HalfPair pair = synthetic_pair(side, side);
  const double sigma = static_cast<double>(state.range(0)) / 10;
  for ([[maybe_unused]] const auto pass : state) benchmark::DoNotOptimize(gaussian_blur(pair.color[0], sigma));
  count_pixels(state);
}
BENCHMARK(gaussian_blur_frame)->ArgName("sigma_x10")->Arg(15)->Arg(40)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace polyrecon::bench
