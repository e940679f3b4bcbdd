#!/usr/bin/env python3
"""The command polyrecon-farm: its sub-commands are modules of this folder."""

import pathlib
import sys

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    __package__ = "pipelines.farm"

from ..common.errors import ExitCode
from . import cost, openjd, report, slurm

COMMANDS = {"slurm": slurm, "openjd": openjd, "report": report, "cost": cost}


def usage():
    lines = ["usage: polyrecon-farm COMMAND ..., with --help for each", ""]
    return "\n".join(lines + [f"  {name:8}{module.__doc__.split('.')[0]}" for name, module in COMMANDS.items()])


def main(words=None):
    words = sys.argv[1:] if words is None else words
    if words and words[0] in COMMANDS:
        return COMMANDS[words[0]].main(words[1:])
    help_requested = bool(words) and words[0] in ("-h", "--help")
    print(usage(), file=sys.stdout if help_requested else sys.stderr)
    return ExitCode.DONE if help_requested else ExitCode.USAGE


if __name__ == "__main__":
    sys.exit(main())
