#pragma once

#include <stdexcept>
#include <string>

namespace polyrecon {

/// Exit codes of the program; documented in README.md, never renumbered.
enum class ExitCode {
  Done = 0,
  Internal = 1,
  Usage = 2,
  BadInput = 3,
  Missing = 4,
  CannotWrite = 5,
  CheckFailed = 6,
  RendererFailed = 7,
  OutOfMemory = 33,
  Interrupted = 130,
  Terminated = 143,
};

/// The one exception type of the project: a fault of input, output or use, never of the numbers (a numerical failure is
/// data: it is counted, reported and falls back). The message is one line that names file, part and channel where they
/// are known, and what to do.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// text up to its first line break: library messages go into one-line errors.
inline std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace polyrecon
