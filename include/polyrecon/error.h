// The exception that the library throws, with the exit code that the program makes of it.
#pragma once

#include <stdexcept>
#include <string>

namespace polyrecon {

/// Exit codes of the program, described in docs/reference/exit_codes.md. The numbers never change.
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

/// The one exception type of the library: wrong use, a faulty input, a failed output, too little memory, or a request
/// to stop. A numerical failure is no exception: it is counted in Report, and the pixels concerned fall back to the
/// input. what() is one line that names file, part and channel where they are known, and says what to do.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace polyrecon
