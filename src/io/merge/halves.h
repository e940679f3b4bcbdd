#pragma once

#include <cstddef>

#include "io/merge/task.h"

namespace polyrecon {

/// Chooses which renders are of half B; see make_task for first_b. Reports halves that are uneven.
void choose_halves(std::size_t first_b, MergeTask& task, MergeResult& report);

}  // namespace polyrecon
