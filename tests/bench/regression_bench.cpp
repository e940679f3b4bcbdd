#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "bench/synthetic.h"
#include "blend/blend_windows.h"
#include "core/simd.h"
#include "polyrecon/params.h"
#include "regression/least_squares.h"
#include "regression/weights.h"

namespace polyrecon::bench {
namespace {

/// Of a window of the default radius.
int window_pixels() {
  const int side = 2 * Params{}.radius + 1;
  return side * side;
}

void count_windows(benchmark::State& state, std::size_t windows) {
  state.SetLabel("items are windows");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(windows));
}

/// For the roofline: floating point operations of the method, and bytes that its loops load and store, each a window.
/// They come from the first two levels of the cache: a window of 14 columns takes 80 KiB.
void count_work(benchmark::State& state, std::size_t windows, double flops, double bytes) {
  const double all = static_cast<double>(state.iterations()) * static_cast<double>(windows);
  state.counters["flop"] = benchmark::Counter(flops * all, benchmark::Counter::kIsRate);
  state.counters["bytes"] = benchmark::Counter(bytes * all, benchmark::Counter::kIsRate);
}

/// Argument: the stride of the centres.
void patch_distances(benchmark::State& state) {
  const Params params;
  const HalfPair pair = synthetic_pair(2 * block_size, 2 * block_size);
  const Rect block{block_size / 2, block_size / 2, block_size / 2 + block_size, block_size / 2 + block_size};
  const Centers centers = lattice(block, static_cast<int>(state.range(0)));
  PatchDistances distances;
  Window window;
  window.reserve(params.radius, 1, 3);
  for ([[maybe_unused]] const auto pass : state) {
    distances.load(pair.color[1], pair.variance, block, params.radius, params.patch);
    for (std::size_t k = 0; k < centers.x.size(); ++k)
      distances.window_of(centers.x[k], centers.y[k], {cut_exponent}, window);
  }
  count_windows(state, centers.x.size());
  // add_differences: 13 operations on 7 samples of a pixel, for each pixel of the patch.
  const double differences = window_pixels() * (2 * params.patch.radius + 1) * (2 * params.patch.radius + 1);
  count_work(state, centers.x.size(), 13 * differences, 7 * sizeof(Real) * differences);
}
BENCHMARK(patch_distances)->ArgName("stride")->Arg(1)->Arg(4)->Unit(benchmark::kMicrosecond);

/// A window with its weights, as the fit sees it.
struct Problem {
  Window window;
  std::vector<Real> weight;
};

Problem problem_of(const BasisLayout& layout) {
  const Params params;
  Problem problem{full_window(synthetic_pair(block_size, block_size), layout, params.radius), {}};
  problem.weight.resize(static_cast<std::size_t>(problem.window.stride));
  // Wide enough that no pixel is cut, so that all of the window's columns are independent.
  kernel_weights(problem.window, Real(4), problem.weight.data());
  return problem;
}

bool is_whole(benchmark::State& state, const Problem& problem, const NestedFactor& factor) {
  const bool whole = problem.window.count == window_pixels() && factor.rank == factor.columns;
  if (!whole) state.SkipWithError("the synthetic window is smaller or of less rank than it is meant to be");
  return whole;
}

/// Argument: the Taylor order; 2 gives 14 columns, 4 gives 23.
void factorise_window(benchmark::State& state) {
  const BasisLayout layout(feature_channels, static_cast<int>(state.range(0)));
  const Problem problem = problem_of(layout);
  NestedFactor factor;
  for ([[maybe_unused]] const auto pass : state) {
    factorise(problem.window, layout.columns(), problem.weight.data(), factor);
    benchmark::DoNotOptimize(factor.q.data());
  }
  if (!is_whole(state, problem, factor)) return;
  state.counters["columns"] = layout.columns();
  count_windows(state, 1);
  // The triangle of the Gram matrix, two tiles of rows with one of columns at a time; q, a tile of columns at a time
  // from those up to them.
  const double n = problem.window.padded, k = layout.columns(), pairs = k * (k - 1) / 2, lanes = vector_lanes;
  const double tiles = std::ceil(k / lanes);
  double gram = 0, q = 0;
  for (double t = 0; t < tiles; t += 2) gram += (tiles - t) * (3 * lanes * sizeof(double) + sizeof(Real));
  for (double t = 1; t <= tiles; ++t) q += std::min(lanes * t, k) * sizeof(double) + lanes * sizeof(Real);
  count_work(state, 1, n * (k + 4 * (pairs + k)), n * (gram + q));
}
BENCHMARK(factorise_window)->ArgName("order")->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);

/// Argument as above.
void project_beauty_window(benchmark::State& state) {
  const BasisLayout layout(feature_channels, static_cast<int>(state.range(0)));
  const Problem problem = problem_of(layout);
  NestedFactor factor;
  factorise(problem.window, layout.columns(), problem.weight.data(), factor);
  if (!is_whole(state, problem, factor)) return;
  std::vector<double> sums(9 * static_cast<std::size_t>(layout.columns()));
  double* column[9];
  for (std::size_t k = 0; k < 9; ++k) column[k] = sums.data() + k * static_cast<std::size_t>(layout.columns());
  for ([[maybe_unused]] const auto pass : state) {
    project_beauty(factor, problem.window, problem.weight.data(), true, column, column + 3, column + 6);
    benchmark::DoNotOptimize(sums.data());
  }
  state.counters["columns"] = layout.columns();
  count_windows(state, 1);
  // Nine channels times the weights, three of them twice; nine sums for each column, a tile of columns at a time,
  // three of them of the columns' squares.
  const double n = problem.window.padded, k = layout.columns();
  const double weighing = n * (9 * (2 * sizeof(Real) + sizeof(double)) + 3 * (sizeof(Real) + 2 * sizeof(double)));
  const double summing = n * std::ceil(k / vector_lanes) * (vector_lanes * sizeof(Real) + 9 * sizeof(double));
  count_work(state, 1, n * (12 + 9 * 2 * k + k), weighing + summing);
}
BENCHMARK(project_beauty_window)->ArgName("order")->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace polyrecon::bench
