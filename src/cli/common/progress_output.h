#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <set>
#include <string>

#include "polyrecon/progress.h"

namespace polyrecon {

enum class ProgressStyle {
  Bar,  ///< A bar where standard error is a terminal; else, in a log, a line at most once a minute.
  None,
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
  /// Prints lines above the bar, if there is one.
  virtual void print(std::FILE* stream, const std::string& text);
  /// Whether this run has not printed the text yet; a note that all frames have is printed once.
  bool is_new(const std::string& text) { return said_.insert(text).second; }

 private:
  std::set<std::string> said_;
};

/// Ends the line of the bar, if it stands on the terminal. Async-signal-safe.
void end_progress_line();

/// Prints progress on standard error, at most ten times a second. cancelled() is true once a signal has arrived
/// (cli/common/signals.h).
std::unique_ptr<RunProgress> make_progress(ProgressStyle style);

}  // namespace polyrecon
