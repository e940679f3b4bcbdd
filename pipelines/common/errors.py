"""The error type of all drivers. Its code is the exit code (docs/reference/exit_codes.md)."""

import enum
import errno
import os
import signal
import sys
import traceback

from .terminal import print_lines


class ExitCode(enum.IntEnum):
    DONE = 0
    INTERNAL = 1
    USAGE = 2
    BAD_INPUT = 3
    MISSING = 4
    OUTPUT = 5
    CHECK = 6
    RENDERER = 7
    MISSED = 8
    MEMORY = 33
    INTERRUPTED = 130
    TERMINATED = 143


class DriverError(Exception):
    """A problem that the user can solve. The text is one line: what happened, to what, and what to do."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = ExitCode(code)


class Terminated(BaseException):
    """The process received SIGTERM. Like KeyboardInterrupt, it unwinds the stack through every `finally`."""


# Exit codes of errors of the system that no driver expects where they occur; of others OUTPUT.
_CODES = {
    errno.ENOENT: ExitCode.MISSING,
    errno.ENOMEM: ExitCode.MEMORY,
    errno.EAGAIN: ExitCode.MEMORY,  # no process or thread to be had
    errno.EMFILE: ExitCode.MEMORY,
    errno.ENFILE: ExitCode.MEMORY,
}
_ADVICE = {errno.EMFILE: ": raise `ulimit -n`", errno.EAGAIN: ": raise `ulimit -u`"}


def _terminate(*_):
    raise Terminated


def run_main(program, main, words=None):
    """Runs main(words) and returns the exit code. Every failure is one line on standard error that begins with the
    program's name. argparse itself reports wrong use, with exit code 2."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        main(words)
        return ExitCode.DONE
    except (Exception, KeyboardInterrupt, Terminated) as error:
        code, text = _explain(error)
        if isinstance(error, BrokenPipeError):  # Nobody reads standard output; Python must not flush it at its end.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, KeyboardInterrupt) and sys.stderr.isatty():
            print(file=sys.stderr)  # The terminal shows ^C where the bar was.
        print_lines(f"{program}: {text}{getattr(error, 'advice', '')}", file=sys.stderr)
        return code


def _explain(error):
    """The exit code and the line for an error."""
    if isinstance(error, DriverError):
        return error.code, error
    if isinstance(error, KeyboardInterrupt):
        return ExitCode.INTERRUPTED, "interrupted"
    if isinstance(error, Terminated):
        return ExitCode.TERMINATED, "terminated"
    if isinstance(error, MemoryError):
        return ExitCode.MEMORY, "not enough memory"
    if isinstance(error, OSError):
        place = f"{os.fsdecode(error.filename)}: " if isinstance(error.filename, (str, bytes)) else ""
        text = f"{place}{error.strerror or error}{_ADVICE.get(error.errno, '')}"
        return _CODES.get(error.errno, ExitCode.OUTPUT), text
    last = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{os.path.basename(last.filename)}:{last.lineno}"
    return ExitCode.INTERNAL, f"internal error: {type(error).__name__}: {error} ({place})"
