#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "polyrecon/progress.h"

namespace polyrecon {

enum class ProgressStyle {
  Auto,  ///< Bar where standard error is a terminal, else none.
  None,
  Bar,    ///< One line per stage that is drawn anew; without a terminal one line at the end of each stage.
  Json,   ///< One JSON object per line: {"event": "begin"|"progress"|"end", "stage", "done", "total", "seconds"}, and
          ///< {"event": "frame", "frame", "done", "total"} where a frame of several begins.
  OpenJd  ///< Open Job Description: `openjd_progress: PERCENT`, `openjd_status: TEXT`, `openjd_fail: TEXT`.
};

/// Progress of a whole run: what the stages tell, and which frame they work on.
class RunProgress : public Progress {
 public:
  /// Frame `done` (counted from 0) of `total` begins.
  virtual void frame(const std::string& label, std::size_t done, std::size_t total);
  /// The run ends with this error.
  virtual void failed(const std::string& message);
};

/// Progress on standard error, at most ten times a second; cancelled() is true once a signal arrived
/// (cli/common/signals.h).
std::unique_ptr<RunProgress> make_progress(ProgressStyle style);

}  // namespace polyrecon
