#pragma once

#include <cstddef>
#include <functional>

#include "polyrecon/progress.h"

namespace polyrecon {

/// Runs body(i) for every i in [0, count) on the threads of the current TBB arena, and reports each finished i to
/// progress. A call of body may only write what no other call reads or writes, so that results do not depend on the
/// order. Throws Error{Interrupted} when progress asks to stop; exceptions of a body are passed on.
void parallel_for(std::size_t count, Progress& progress, const std::function<void(std::size_t)>& body);

/// The same without reports, for short work.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& body);

/// Runs body(y) for every row of an image in parallel, without reports.
void for_rows(int height, const std::function<void(int)>& body);

/// Sum of term(i) for i in [0, count). Terms are computed in parallel and added in order of i, so the sum has the same
/// bits for any number of threads. A term should be the sum over a row or a block, not a single sample.
double ordered_sum(std::size_t count, const std::function<double(std::size_t)>& term);

/// Number of processors that the process may use; at least 1.
int processors();

/// Number of threads that work at the same time: that of set_thread_limit or of the current TBB arena, else of the
/// processors.
int threads();

/// Limits the number of threads of this process; 0 means all processors.
void set_thread_limit(int threads);

}  // namespace polyrecon
