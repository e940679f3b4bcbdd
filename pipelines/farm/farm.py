#!/usr/bin/env python3
"""The command polyrecon-farm: its sub-commands are modules of this folder."""

import argparse
import pathlib
import sys

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.farm"

from ..common.modules import required

with required("polyrecon-farm", ()):
    from ..common.arguments import Parser
    from . import cost, openjd, report, slurm

COMMANDS = {"slurm": slurm, "openjd": openjd, "report": report, "cost": cost}


def main(words=None):
    words = list(sys.argv[1:] if words is None else words)
    if words[:1] == ["help"]:
        words = [*words[1:2], "--help"]
    subjects = {name: module.__doc__.split(".")[0].replace("\n", " ") for name, module in COMMANDS.items()}
    parser = Parser(
        "polyrecon-farm",
        words=("help",),
        usage="%(prog)s COMMAND ..., %(prog)s help COMMAND",
        description="\n".join(["commands:", *(f"  {name:8}{subject}" for name, subject in subjects.items())]),
    )
    parser.add_argument("command", choices=COMMANDS, metavar="COMMAND", help=argparse.SUPPRESS)
    command = parser.parse_args(words[:1]).command
    return COMMANDS[command].main(words[1:])


if __name__ == "__main__":
    sys.exit(main())
