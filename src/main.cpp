#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "cli/app.h"
#include "cli/common/current_error.h"
#include "cli/common/printed_text.h"
#include "cli/common/signals.h"
#include "io/files/atomic_file.h"
#include "polyrecon/error.h"

namespace {

using polyrecon::Command;
using polyrecon::ExitCode;

/// Prints the message as one line; messages of libraries may contain line breaks.
int fail(ExitCode code, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fputs(polyrecon::text_line("polyrecon: {}", message).c_str(), stderr);
  return static_cast<int>(code);
}

/// Parses the command line. The command is empty after --help and --version, which need no work.
Command parse(int argc, char** argv) {
  CLI::App app;
  Command chosen;
  polyrecon::setup_app(app, chosen);
  const auto known = app.get_subcommands([&](const CLI::App* sub) { return argc > 1 && sub->get_name() == argv[1]; });
  if (argc > 1 && argv[1][0] != '-' && known.empty())
    throw polyrecon::Error(ExitCode::Usage,
                           fmt::format("'{}' is no command (polyrecon --help lists the commands)", argv[1]));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0)
      throw polyrecon::Error(ExitCode::Usage, std::string(e.what()) + " (polyrecon COMMAND --help shows the options)");
    app.exit(e);
  }
  return chosen;
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
    const Command command = parse(argc, argv);
    polyrecon::catch_signals();
    if (command) command();
    polyrecon::require_output_written();
    return static_cast<int>(ExitCode::Done);
  } catch (const std::exception&) {
    const polyrecon::Error error = polyrecon::current_error();
    return fail(code_of(error), error.what());
  }
}
