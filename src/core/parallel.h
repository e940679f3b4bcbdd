#pragma once

#include <cstddef>
#include <functional>

#include "polyrecon/progress.h"

namespace polyrecon {

/// Runs body(i) for every i in [0, count) on the threads of the current TBB arena, and reports each finished i to
/// progress. Results must not depend on the order: a body writes only what no other body touches.
/// Throws Error{Interrupted} when progress asks to stop; exceptions of a body are passed on.
void parallel_for(std::size_t count, Progress& progress, const std::function<void(std::size_t)>& body);

/// The same for work too short to be reported.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& body);

/// body(y) for every row of an image, as in_parallel.
void for_rows(int height, const std::function<void(int)>& body);

/// Sum of term(i) for i in [0, count). The sum is taken in order of i, so it has the same bits for any number of
/// threads; make one term a row or a block, not a sample.
double ordered_sum(std::size_t count, const std::function<double(std::size_t)>& term);

/// Processors of this machine that the process may use; at least 1.
int processors();

/// Limits the threads used from here on in this process; 0 means all processors.
void set_thread_limit(int threads);

}  // namespace polyrecon
