// How long work reports its progress and is asked to stop.
#pragma once

#include <cstddef>
#include <string_view>

namespace polyrecon {

/// Receives the progress of a computation and may cancel it. It is called from any thread, so an implementation must be
/// thread-safe. The base class ignores progress and never cancels.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A phase of the computation begins; it consists of this many units of work.
  virtual void begin(std::string_view phase, std::size_t units);
  /// This many more units of the current phase are done.
  virtual void advance(std::size_t units);
  /// The current phase ends.
  virtual void end();
  /// Whether to stop. The computation then throws Error{Interrupted}; this function itself must not throw.
  virtual bool cancelled() const;
};

/// For callers that want neither a report nor a way to cancel.
Progress& silent_progress();

}  // namespace polyrecon
