#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "cli/app.h"
#include "cli/common/signals.h"
#include "polyrecon/error.h"

namespace {

using polyrecon::Command;
using polyrecon::ExitCode;

/// Prints the message as one line; messages of libraries may contain line breaks.
int fail(ExitCode code, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fputs(fmt::format("polyrecon: {}\n", message).c_str(), stderr);
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

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  try {
    const Command command = parse(argc, argv);
    polyrecon::catch_signals();
    if (command) command();
    polyrecon::require_output_written();
    return static_cast<int>(ExitCode::Done);
  } catch (const polyrecon::Error& e) {
    return fail(code_of(e), e.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::OutOfMemory, "not enough memory: lower --max-memory, or use fewer passes");
  } catch (const std::exception& e) {
    return fail(ExitCode::Internal, std::string("internal error: ") + e.what());
  }
}
