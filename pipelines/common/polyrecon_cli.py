"""Finds and runs the polyrecon program."""

import os
import pathlib
import shutil

from . import process
from .errors import DriverError, ExitCode

BUILDS = ("release", "dev")
WRITING = ("denoise", "merge", "preview", "samplemap", "view")  # Commands with --overwrite.


def find_polyrecon(given=None):
    """The path of the program. `given` is the value of --polyrecon. Without it, $POLYRECON, the program that was
    installed with these drivers, the PATH and the builds of this checkout are tried."""
    named = given or os.environ.get("POLYRECON")
    if named:
        if not (found := shutil.which(named)):  # a path, or a name on the PATH
            raise DriverError(ExitCode.MISSING, f"{named}: no such program (--polyrecon, $POLYRECON)")
        return pathlib.Path(found).absolute()
    root = pathlib.Path(__file__).resolve().parents[2]  # a folder of Python's packages, or a checkout
    for found in (shutil.which(root / "polyrecon" / "bin" / "polyrecon"), shutil.which("polyrecon")):
        if found:
            return pathlib.Path(found)
    for build in BUILDS:
        if os.access(program := root / "build" / build / "src" / "polyrecon", os.X_OK):
            return program
    raise DriverError(
        ExitCode.MISSING, "polyrecon is neither on the PATH nor built in this checkout: give --polyrecon PATH"
    )


class Polyrecon:
    """Runs commands of polyrecon. An error has the exit code and the last line of the program."""

    def __init__(self, path=None):
        self.program = find_polyrecon(path)

    def describe(self):
        """Its name, version and path."""
        return f"{self.version()} ({self.program})"

    def version(self):
        """Its name and version."""
        code, output, errors = process.run([self.program, "--version"])
        if code != 0 or not output.startswith("polyrecon "):
            reason = (process.lines_of(errors) or [f"--version ends with code {code}"])[-1]
            if reason.startswith("polyrecon: ") and code in ExitCode.__members__.values():  # It has too few resources.
                raise DriverError(code, f"{self.program}: {reason.removeprefix('polyrecon: ')}")
            raise DriverError(ExitCode.MISSING, f"{self.program}: is not polyrecon: {reason}")
        return output.strip()

    def check_options(self, command, *words):
        """Raises DriverError where a sub-command would refuse these options. No file is looked at."""
        code, _, errors = process.run([self.program, "--check-options", command, *words])
        if code:
            line = (process.lines_of(errors) or [f"ended with code {code}"])[-1].removeprefix("polyrecon: ")
            raise DriverError(ExitCode.USAGE, line)

    def run(self, command, *words):
        """Runs one sub-command; returns its standard output."""
        return self.run_side_by_side(command, [words])[0]

    def run_side_by_side(self, command, word_lists):
        """Runs one sub-command concurrently with each list of words; returns the standard outputs. Files that exist are
        replaced: a driver checks its own outputs before it begins."""
        overwrite = ["--overwrite"] if command in WRITING else []
        results = process.run_side_by_side([[self.program, command, *words, *overwrite] for words in word_lists])
        for code, _, errors in results:
            if code != 0:
                lines = [line for line in process.lines_of(errors) if line.strip()] or [f"ended with code {code}"]
                known = code in ExitCode.__members__.values()
                raise DriverError(
                    code if known else ExitCode.INTERNAL,
                    f"polyrecon {command}: {lines[-1].removeprefix('polyrecon: ')}",
                )
        return [output for _, output, _ in results]
