"""The program `polyrecon`, which the wheel brings along."""

from __future__ import annotations

import os
import pathlib
import shutil
import sys

from ._library import Error

MISSING = 4


def program() -> str:
    """The path of the program: the one in this package, else the first on the PATH."""
    own = pathlib.Path(__file__).parent / "bin" / "polyrecon"
    found = str(own) if own.exists() else shutil.which("polyrecon")
    if not found:
        raise Error("there is no program polyrecon: install the wheel or the Debian package polyrecon", MISSING)
    return found


def main() -> None:
    """The command `polyrecon`: this process becomes the program."""
    os.execv(program(), ["polyrecon", *sys.argv[1:]])
