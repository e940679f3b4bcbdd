"""The command line of every driver: one line about wrong use, the nearest option for one that does not exist, the
default of each option in its help, and --version."""

import argparse
import difflib
import os
import re
import sys

from .errors import DriverError, ExitCode
from .polyrecon_cli import Polyrecon
from .terminal import print_lines
from .version import VERSION

_CHOICES = re.compile(r"invalid choice: '?(?P<value>.*?)'? \(choose from (?P<choices>.*)\)")


class Parser(argparse.ArgumentParser):
    """program: name of the installed command, and of its sub-command if it has one. The description and the epilog are
    shown as they are, with %(prog)s for what the user typed. words: what may stand in place of a choice."""

    def __init__(self, program=None, prog=None, words=(), **options):
        self.program = program or prog
        self.words = words
        options.setdefault("formatter_class", _Help)
        options.setdefault("allow_abbrev", False)  # As in the program: a new option makes no old command ambiguous.
        super().__init__(prog=prog or typed_name(program), **options)
        self.add_argument("--version", action=_Version, help="print the versions of driver and program, and exit")

    def parse_known_args(self, args=None, namespace=None):
        words = list(sys.argv[1:] if args is None else args)
        if self._subparsers is None:
            self._check_names(words)
        return super().parse_known_args(words, namespace)

    def error(self, message):
        """Ends the program with exit code 2 and one line."""
        if match := _CHOICES.search(message):
            message += _suggestion(match["value"], [*re.findall(r"[\w-]+", match["choices"]), *self.words])
        print_lines(f"{self.program}: {message}; see {self.prog} --help", file=sys.stderr)
        sys.exit(ExitCode.USAGE)

    def _check_names(self, words):
        """argparse names a missing option before an unknown one, which may be the missing one misspelt."""
        for word in words[: words.index("--")] if "--" in words else words:
            name = word.partition("=")[0]
            if re.match("--[a-z]", name) and name not in self._option_string_actions:
                self.error(f"unknown option {name}{_suggestion(name, self._option_string_actions)}")


def typed_name(program):
    """The words that start the command: its name where it is installed, the script in a checkout."""
    first, *sub_command = program.split()
    script = sys.argv[0]
    if os.path.basename(script) == first or not script.endswith(".py"):
        return program
    if [os.path.basename(script)[:-3]] == sub_command:
        return script
    return " ".join([script, *sub_command])


def _suggestion(word, known):
    nearest = difflib.get_close_matches(word, known, 1)
    return f": did you mean {nearest[0]}?" if nearest else ""


class _Help(argparse.RawDescriptionHelpFormatter):
    def _get_help_string(self, action):
        """The help of an option with its default. Where the default is None, the text of the option says what happens
        then."""
        has_value = action.option_strings and action.nargs != 0
        if has_value and action.default not in (None, [], argparse.SUPPRESS):
            return f"{action.help} (default: %(default)s)"
        return action.help


class _Version(argparse.Action):
    def __init__(self, option_strings, dest, **options):
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, default=argparse.SUPPRESS, help=options["help"])

    def __call__(self, parser, namespace, *_):
        print_lines(f"{parser.program.split()[0]} {VERSION}")
        try:
            print_lines(Polyrecon(getattr(namespace, "polyrecon", None)).describe())
        except DriverError as error:
            print_lines(error)
        parser.exit()


def positive(text):
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text}: must be a number above 0")
    return value


def add_pass_timeout(parser, default=None):
    """Adds --pass-timeout, in seconds. None: a pass may take as long as it likes."""
    parser.add_argument(
        "--pass-timeout",
        "--timeout",
        type=positive,
        default=default,
        metavar="S",
        help="seconds after which a run of the renderer has failed" + ("" if default else " (default: no limit)"),
    )


def add_program(parser):
    """Adds --polyrecon."""
    parser.add_argument(
        "--polyrecon",
        metavar="PATH",
        help="the program, a path or a name on the PATH (default: $POLYRECON, else `polyrecon`)",
    )


def add_verbosity(parser):
    """Adds -q and -v."""
    verbosity = parser.add_mutually_exclusive_group()
    verbosity.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")
    verbosity.add_argument("-v", "--verbose", action="store_true", help="also print what was decided, and why")
