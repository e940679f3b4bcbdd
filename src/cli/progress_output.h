#pragma once

#include <memory>

#include "core/progress.h"

namespace polyrecon {

enum class ProgressStyle {
  Auto,  ///< Bar where standard error is a terminal, else none.
  None,
  Bar,  ///< One line per stage that is drawn anew; without a terminal one line at the end of each stage.
  Json  ///< One JSON object per line: {"event": "begin"|"progress"|"end", "stage", "done", "total", "seconds"}.
};

/// From here on SIGINT and SIGTERM ask the running stage to stop; a second one ends the process at once.
void catch_signals();

/// The signal that arrived, 0 before.
int caught_signal();

/// Progress on standard error, at most ten times a second; cancelled() is true once a signal arrived.
std::unique_ptr<Progress> make_progress(ProgressStyle style);

}  // namespace polyrecon
