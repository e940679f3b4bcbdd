"""Finds and runs the polyrecon program."""

import os
import pathlib
import shutil

from . import process
from .errors import DriverError, ExitCode

BUILDS = ("release", "dev")


def find_polyrecon(given=None):
    """--polyrecon PATH, else $POLYRECON, else on the PATH, else the build of this checkout."""
    named = given or os.environ.get("POLYRECON")
    if named:
        if not (found := shutil.which(named)):  # a path, or a name on the PATH
            raise DriverError(ExitCode.MISSING, f"{named}: no such program (--polyrecon, $POLYRECON)")
        return pathlib.Path(found).absolute()
    if found := shutil.which("polyrecon"):
        return pathlib.Path(found)
    root = pathlib.Path(__file__).resolve().parents[2]
    for build in BUILDS:
        if os.access(program := root / "build" / build / "src" / "polyrecon", os.X_OK):
            return program
    raise DriverError(ExitCode.MISSING, "polyrecon is not on the PATH and not built here: name it by --polyrecon")


class Polyrecon:
    """polyrecon's commands as methods. A failure keeps the program's own exit code and line."""

    def __init__(self, path=None):
        self.program = find_polyrecon(path)

    def run(self, command, *words):
        """Runs one sub-command; returns what it printed."""
        return self.run_side_by_side(command, [words])[0]

    def run_side_by_side(self, command, several):
        """Runs one sub-command with several lists of words at the same time."""
        answers = process.run_side_by_side([[self.program, command, *words] for words in several])
        for code, _, errors in answers:
            if code != 0:
                lines = [line for line in errors.splitlines() if line.strip()] or [f"ended with code {code}"]
                known = code in ExitCode.__members__.values()
                raise DriverError(code if known else ExitCode.INTERNAL, f"polyrecon {command}: {lines[-1]}")
        return [output for _, output, _ in answers]
