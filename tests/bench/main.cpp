#include <benchmark/benchmark.h>

#include "core/parallel.h"

/// One thread only: what a core does is comparable between machines and hardly depends on what else runs.
int main(int argc, char** argv) {
  polyrecon::set_thread_limit(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
