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

/// Pixels of a window of the default radius.
int window_pixels() {
  const int side = 2 * Params{}.radius + 1;
  return side * side;
}

void count_windows(benchmark::State& state, std::size_t windows) {
  state.SetLabel("items are windows");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(windows));
}

/// Counts floating-point operations, and bytes that loops load and store, for the roofline; both are per window. The
/// bytes are in the first two levels of the cache, as a window of 14 columns has 80 KiB.
void count_work(benchmark::State& state, std::size_t windows, double flops, double bytes) {
  const double all = static_cast<double>(state.iterations()) * static_cast<double>(windows);
  state.counters["flop"] = benchmark::Counter(flops * all, benchmark::Counter::kIsRate);
  state.counters["bytes"] = benchmark::Counter(bytes * all, benchmark::Counter::kIsRate);
}

/// Argument: distance between centres.
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
  // add_differences has 13 operations on 7 samples for each pixel of the patch.
  const double differences = window_pixels() * (2 * params.patch.radius + 1) * (2 * params.patch.radius + 1);
  count_work(state, centers.x.size(), 13 * differences, 7 * sizeof(Real) * differences);
}
BENCHMARK(patch_distances)->ArgName("stride")->Arg(1)->Arg(4)->Unit(benchmark::kMicrosecond);

/// A window with its weights.
struct Problem {
  Window window;
  std::vector<Real> weight;
};

Problem problem_of(const BasisLayout& layout) {
  const Params params;
  Problem problem{full_window(synthetic_pair(block_size, block_size), layout, params.radius), {}};
  problem.weight.resize(static_cast<std::size_t>(problem.window.stride));
  // The bandwidth is so wide that no pixel is cut off; then all columns are independent.
  kernel_weights(problem.window, Real(4), problem.weight.data());
  return problem;
}

bool is_whole(benchmark::State& state, const Problem& problem, const NestedFactor& factor) {
  const bool whole = problem.window.count == window_pixels() && factor.rank == factor.columns;
  if (!whole) state.SkipWithError("the synthetic window has too few pixels or too low a rank");
  return whole;
}

/// Argument: the Taylor order; order 2 has 14 columns, order 4 has 23.
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
  // The triangle of the Gram matrix is computed by two tiles of rows and one tile of columns at a time. q is computed a
  // tile of columns at a time, from the columns up to there.
  const double n = problem.window.padded, k = layout.columns(), pairs = k * (k - 1) / 2, lanes = vector_lanes;
  const double tiles = std::ceil(k / lanes);
  double gram = 0, q = 0;
  for (double t = 0; t < tiles; t += 2) gram += (tiles - t) * (3 * lanes * sizeof(double) + sizeof(Real));
  for (double t = 1; t <= tiles; ++t) q += std::min(lanes * t, k) * sizeof(double) + lanes * sizeof(Real);
  count_work(state, 1, n * (k + 4 * (pairs + k)), n * (gram + q));
}
BENCHMARK(factorise_window)->ArgName("order")->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);

/// Argument: the Taylor order.
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
  // Nine channels are multiplied by the weights, three of them twice. Each column has nine sums, three of them over its
  // squares, computed a tile of columns at a time.
  const double n = problem.window.padded, k = layout.columns();
  const double weighing = n * (9 * (2 * sizeof(Real) + sizeof(double)) + 3 * (sizeof(Real) + 2 * sizeof(double)));
  const double summing = n * std::ceil(k / vector_lanes) * (vector_lanes * sizeof(Real) + 9 * sizeof(double));
  count_work(state, 1, n * (12 + 9 * 2 * k + k), weighing + summing);
}
BENCHMARK(project_beauty_window)->ArgName("order")->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace polyrecon::bench
