"""The error type of all drivers. Its code is the exit code (docs/reference/exit_codes.md)."""

import enum
import signal
import sys


class ExitCode(enum.IntEnum):
    DONE = 0
    INTERNAL = 1
    USAGE = 2
    BAD_INPUT = 3
    MISSING = 4
    OUTPUT = 5
    CHECK = 6
    RENDERER = 7
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


def _terminate(*_):
    raise Terminated


def run_main(program, main, words=None):
    """Runs main(words) and returns the exit code. Every failure is one line on standard error that begins with the
    program's name. argparse itself reports wrong use, with exit code 2."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        main(words)
        return ExitCode.DONE
    except DriverError as error:
        print(f"{program}: {error}", file=sys.stderr)
        return error.code
    except KeyboardInterrupt:
        print(f"{program}: interrupted", file=sys.stderr)
        return ExitCode.INTERRUPTED
    except Terminated:
        print(f"{program}: terminated", file=sys.stderr)
        return ExitCode.TERMINATED
    except MemoryError:
        print(f"{program}: not enough memory", file=sys.stderr)
        return ExitCode.MEMORY
