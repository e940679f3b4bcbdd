#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "polyrecon/progress.h"

namespace polyrecon {

enum class ProgressStyle {
  Auto,  ///< A bar where standard error is a terminal, else nothing.
  None,
  Bar,    ///< A line for each phase, redrawn on a terminal; elsewhere printed at the end of the phase.
  Json,   ///< A JSON object per line: {"event": "begin"|"progress"|"end", "phase", "done", "total", "seconds"}, and
          ///< {"event": "frame", "frame", "done", "total"} where a frame of a sequence begins.
  OpenJd  ///< Open Job Description: `openjd_progress: PERCENT`, `openjd_status: TEXT`, `openjd_fail: TEXT`.
};

/// Progress of a whole run: that of the phases, and of the frames.
class RunProgress : public Progress {
 public:
  /// Frame `done` of `total` begins; the first one is frame 0.
  virtual void frame(const std::string& label, std::size_t done, std::size_t total);
  /// The run ends with this error.
  virtual void failed(const std::string& message);
};

/// Prints progress on standard error, at most ten times a second. cancelled() is true once a signal has arrived
/// (cli/common/signals.h).
std::unique_ptr<RunProgress> make_progress(ProgressStyle style);

}  // namespace polyrecon
