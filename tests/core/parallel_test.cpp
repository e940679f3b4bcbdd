#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "polyrecon/error.h"
#include "support/threads.h"

namespace polyrecon {
namespace {

TEST(ParallelFor, RunsEachIndexOnceAndReportsIt) {
  struct Counting : Progress {
    std::atomic<std::size_t> steps{0};
    void advance(std::size_t n) override { steps += n; }
  } progress;
  std::vector<std::atomic<int>> runs(1000);
  parallel_for(runs.size(), progress, [&](std::size_t i) { ++runs[i]; });
  for (const auto& r : runs) EXPECT_EQ(r.load(), 1);
  EXPECT_EQ(progress.steps.load(), 1000u);
}

TEST(ParallelFor, StopsWhenAskedTo) {
  struct Cancelled : Progress {
    bool cancelled() const override { return true; }
  } progress;
  try {
    parallel_for(10, progress, [](std::size_t) {});
    FAIL() << "ran to its end";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::Interrupted);
  }
}

TEST(ParallelFor, PassesABodysExceptionOn) {
  EXPECT_THROW(parallel_for(10, silent_progress(),
                            [](std::size_t i) {
                              if (i == 7) throw Error(ExitCode::BadInput, "seven");
                            }),
               Error);
}

TEST(OrderedSum, HasTheSameBitsForAnyNumberOfThreads) {
  // The terms differ so much in size and sign that any other order changes the last bits of the sum.
  const auto term = [](std::size_t i) {
    return std::sin(static_cast<double>(i)) * std::pow(10.0, static_cast<double>(i % 17));
  };
  double in_order = 0;
  for (std::size_t i = 0; i < 5000; ++i) in_order += term(i);
  for (const int threads : {1, 2, 8, 16})
    EXPECT_EQ(test::with_threads(threads, [&] { return ordered_sum(5000, term); }), in_order) << threads;
}

}  // namespace
}  // namespace polyrecon
