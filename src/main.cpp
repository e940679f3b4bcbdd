#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "cli/common/current_error.h"
#include "cli/common/printed_text.h"
#include "cli/common/progress_output.h"
#include "cli/common/signals.h"
#include "cli/parse.h"
#include "io/files/atomic_file.h"
#include "polyrecon/error.h"

namespace {

using polyrecon::Command;
using polyrecon::ExitCode;

/// Prints the message as one line; messages of libraries may contain line breaks.
int fail(ExitCode code, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  polyrecon::end_progress_line();
  std::fputs(polyrecon::text_line("polyrecon: {}", message).c_str(), stderr);
  return static_cast<int>(code);
}

/// Keeps freed memory in the process: images are allocated and freed by the dozen, and the system clears memory that it
/// gets back before it is used again.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

ExitCode code_of(const polyrecon::Error& error) {
  return error.code() == ExitCode::Interrupted && polyrecon::caught_signal() == SIGTERM ? ExitCode::Terminated
                                                                                        : error.code();
}

/// Ends the program as main does, for an exception that nobody can catch: libraries throw some in their threads, and
/// where a function may not throw, as when no thread can be started.
[[noreturn]] void end_at_once() {
  ExitCode code = ExitCode::Internal;
  try {
    if (std::current_exception()) {
      const polyrecon::Error error = polyrecon::current_error();
      code = code_of(error);
      fail(code, error.what());
    } else {
      fail(code, "internal error: terminated");
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): no memory for the message
  }
  polyrecon::remove_temporaries();
  std::_Exit(static_cast<int>(code));
}

/// With fewer, files that are whole fail to open, and libraries that are loaded late too.
void require_open_files() {
  constexpr rlim_t least = 32;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < least)
    throw polyrecon::Error(
        ExitCode::OutOfMemory,
        fmt::format("{} open files are allowed, {} are needed: raise ulimit -n", limit.rlim_cur, least));
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  std::set_terminate(end_at_once);
  try {
    require_open_files();
    const Command command = polyrecon::parse_command_line({argv + (argc > 0 ? 1 : 0), argv + argc});
    polyrecon::catch_signals();
    const int code = command.run ? command.run() : static_cast<int>(ExitCode::Done);
    polyrecon::require_output_written();
    return code;
  } catch (const std::exception&) {
    const polyrecon::Error error = polyrecon::current_error();
    return fail(code_of(error), error.what());
  }
}
