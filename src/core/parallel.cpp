#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "polyrecon/error.h"

namespace polyrecon {

void parallel_for(std::size_t count, Progress& progress, const std::function<void(std::size_t)>& body) {
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (progress.cancelled()) throw Error(ExitCode::Interrupted, "interrupted");
    body(i);
    progress.advance(1);
  });
}

void in_parallel(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::parallel_for(std::size_t{0}, count, body);
}

void for_rows(int height, const std::function<void(int)>& body) {
  in_parallel(static_cast<std::size_t>(height), [&](std::size_t y) { body(static_cast<int>(y)); });
}

double ordered_sum(std::size_t count, const std::function<double(std::size_t)>& term) {
  std::vector<double> terms(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { terms[i] = term(i); });
  double sum = 0;
  for (const double t : terms) sum += t;
  return sum;
}

int processors() { return tbb::info::default_concurrency(); }

int threads() {
  const std::size_t limit = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const int most = std::min(processors(), tbb::this_task_arena::max_concurrency());
  return static_cast<int>(std::min(limit, static_cast<std::size_t>(most)));
}

void set_thread_limit(int threads) {
  static std::unique_ptr<tbb::global_control> limit;
  limit.reset();
  if (threads > 0)
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(threads));
}

}  // namespace polyrecon
