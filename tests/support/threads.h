#pragma once

#include <tbb/task_arena.h>

#include "core/parallel.h"

namespace polyrecon::test {

/// Runs work on up to this many threads, even if there are fewer processors.
template <typename Work>
auto with_threads(int threads, const Work& work) {
  set_thread_limit(threads);
  tbb::task_arena arena(threads);
  auto result = arena.execute(work);
  set_thread_limit(0);
  return result;
}

}  // namespace polyrecon::test
