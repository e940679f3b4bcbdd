#include <benchmark/benchmark.h>

#include "core/parallel.h"

/// Benchmarks run on one thread, so that results of different machines compare and depend little on their load.
int main(int argc, char** argv) {
  polyrecon::set_thread_limit(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
