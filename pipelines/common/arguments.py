"""Types of command line arguments, for argparse."""

import argparse


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
        help=f"seconds after which a run of the renderer has failed ({default or 'none'})",
    )
