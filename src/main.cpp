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

/// One line, whatever a library put into its message.
int fail(ExitCode code, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fputs(fmt::format("polyrecon: {}\n", message).c_str(), stderr);
  return static_cast<int>(code);
}

/// Parses the command line into the work to do. Returns nothing to do after --help or --version, with exit code 0.
Command parse(int argc, char** argv) {
  CLI::App app;
  Command chosen;
  polyrecon::setup_app(app, chosen);
  const auto known = app.get_subcommands([&](const CLI::App* sub) { return argc > 1 && sub->get_name() == argv[1]; });
  if (argc > 1 && argv[1][0] != '-' && known.empty())
    throw polyrecon::Error(ExitCode::Usage, fmt::format("no command '{}' (polyrecon --help lists them)", argv[1]));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0)
      throw polyrecon::Error(ExitCode::Usage, std::string(e.what()) + " (polyrecon COMMAND --help shows the options)");
    app.exit(e);
  }
  return chosen;
}

/// Images come and go by the dozen: memory that went back to the system each time would be cleared for each anew.
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
    return fail(ExitCode::OutOfMemory, "not enough memory: lower --max-memory, or give fewer passes");
  } catch (const std::exception& e) {
    return fail(ExitCode::Internal, std::string("internal error: ") + e.what());
  }
}
