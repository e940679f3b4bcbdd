#include "cli/common/signals.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <string_view>

#include "cli/common/progress_output.h"
#include "io/files/atomic_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr unsigned patience = 4;  // seconds

volatile std::sig_atomic_t arrived = 0, polled = 0, reader_gone = 0;

[[noreturn]] void leave(int signal) {
  remove_temporaries();
  end_progress_line();
  constexpr std::string_view line = "polyrecon: interrupted\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
  ::_exit(128 + signal);
}

extern "C" void stop(int signal) {
  if (!polled || arrived) leave(arrived ? arrived : signal);
  arrived = signal;
  ::alarm(patience);
}

extern "C" void stop_at_last(int /*signal*/) { leave(arrived); }

extern "C" void note_closed_pipe(int /*signal*/) { reader_gone = 1; }

void handle(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void catch_signals() {
  handle(SIGINT, stop);
  handle(SIGTERM, stop);
  handle(SIGALRM, stop_at_last);
  handle(SIGPIPE, note_closed_pipe);
  handle(SIGXFSZ, SIG_IGN);  // a write beyond the limit then fails, as on a full disk
}

void poll_signals() { polled = 1; }

int caught_signal() { return arrived; }

void require_output_written() {
  const bool failed = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
  if (failed && !reader_gone)
    throw Error(ExitCode::CannotWrite, "standard output: cannot be written; check that the disk is not full");
}

}  // namespace polyrecon
