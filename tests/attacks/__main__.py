"""Attacks a program with hostile input of many kinds and counts what gets through.

python3 -m tests.attacks PROGRAM [KIND ...] [options]; --help lists them.
"""

import argparse
import importlib
import sys
import tempfile

from tests.attacks.program import MEGABYTE, Program, Tally

KINDS = ("variants", "headers", "decoders", "numbers", "swaps", "names", "special_files", "limits")
FRAME_MEMORY = 300 * MEGABYTE


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=f"default: all of {', '.join(KINDS)}")
    parser.add_argument("--count", type=int, default=100, help="inputs of the kinds that are random (default 100)")
    parser.add_argument("--commands", type=int, default=4, help="about so many commands on each input (default 4)")
    parser.add_argument("--seconds", type=float, default=3600, help="after which a kind ends (default 3600)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--seeds", nargs="*", default=[], metavar="FOLDER", help="folders of further EXR files to begin with"
    )
    parser.add_argument(
        "--server", metavar="FILE", help="build/dev/src/attack_server: many runs a second (target attack_server)"
    )
    parser.add_argument("--keep", metavar="FOLDER", help="where inputs that got through are kept")
    options = parser.parse_args()
    print("| attack | inputs | runs | got through | exit codes |\n|---|---:|---:|---:|---|", flush=True)
    through = 0
    for kind in options.kinds or KINDS:
        with tempfile.TemporaryDirectory(prefix="polyrecon_attacks_") as folder:
            tally = Tally(kind, options.keep, options.seconds)
            tally.seed, tally.memory, tally.commands = options.seed, FRAME_MEMORY, options.commands
            program = Program(options.program, folder, options.server)
            importlib.import_module(f"tests.attacks.{kind}").attack(program, tally, options.count, options.seeds)
            program.close()
            print(tally.row(), flush=True)
            through += tally.through
    return 1 if through else 0


if __name__ == "__main__":
    sys.exit(main())
