#include <benchmark/benchmark.h>

#include <vector>

#include "core/simd.h"

// Peak performance of one core for the roofline of docs/results/performance.md: multiply-add in registers, and
// bandwidth of each level of memory.

namespace polyrecon::bench {
namespace {

constexpr int chains = 12;  ///< Independent vectors: enough to fill the pipelines, few enough for the registers.

/// Multiply-add, fused if the processor can, as in the fits: CMakeLists.txt gives this file the same options.
template <typename T>
POLYRECON_SIMD void multiply_and_add(T* values, T factor, T summand, int rounds) {
  using Vector [[gnu::vector_size(64)]] = T;
  constexpr int lanes = sizeof(Vector) / sizeof(T);
  Vector v[chains];
  for (int k = 0; k < chains; ++k)
    for (int j = 0; j < lanes; ++j) v[k][j] = values[k * lanes + j];
  for (int round = 0; round < rounds; ++round)
    for (int k = 0; k < chains; ++k) v[k] = v[k] * factor + summand;
  for (int k = 0; k < chains; ++k)
    for (int j = 0; j < lanes; ++j) values[k * lanes + j] = v[k][j];
}

template <typename T>
void peak(benchmark::State& state) {
  constexpr int rounds = 10000;
  std::vector<T> values(chains * 64 / sizeof(T), T(1));
  for ([[maybe_unused]] const auto pass : state) {
    multiply_and_add(values.data(), T(0.999), T(0.001), rounds);
    benchmark::DoNotOptimize(values.data());
  }
  state.counters["flop"] =
      benchmark::Counter(2.0 * static_cast<double>(values.size()) * rounds * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}
BENCHMARK(peak<float>);
BENCHMARK(peak<double>);

POLYRECON_SIMD void triad(float* a, const float* b, const float* c, std::size_t n) {
  for (std::size_t j = 0; j < n; ++j) a[j] = b[j] + 0.5F * c[j];
}

/// Argument: size of the three arrays together, KiB.
void bandwidth(benchmark::State& state) {
  const std::size_t n = static_cast<std::size_t>(state.range(0)) * 1024 / (3 * sizeof(float));
  std::vector<float> a(n, 0), b(n, 1), c(n, 2);
  for ([[maybe_unused]] const auto pass : state) {
    triad(a.data(), b.data(), c.data(), n);
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
  state.counters["bytes"] =
      benchmark::Counter(3.0 * sizeof(float) * static_cast<double>(n) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}
BENCHMARK(bandwidth)->ArgName("KiB")->Arg(24)->Arg(1024)->Arg(1 << 20);

}  // namespace
}  // namespace polyrecon::bench
