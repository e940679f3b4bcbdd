"""The options of a submission, for every engine."""

import argparse
import re

from ..common import arguments
from ..common.arguments import add_program, add_verbosity
from ..common.decode import NUMBER_LIMIT
from ..common.frame_names import is_pattern


def size(text):
    """The bytes of a text such as 512M or 4G."""
    match = re.fullmatch(r"(\d+(?:\.\d+)?)([KMGT]?)", text.strip().upper())
    if not match:
        raise argparse.ArgumentTypeError(f"{text}: write it as 512M or 4G")
    number = float(match[1]) * 1024 ** (" KMGT".index(match[2] or " "))
    if number >= NUMBER_LIMIT:
        raise argparse.ArgumentTypeError(f"{text}: is too large")
    return int(number)


def positive(text):
    number = int(text)
    if not 1 <= number < NUMBER_LIMIT:
        raise argparse.ArgumentTypeError(f"{text}: must be at least 1, and below 2^63")
    return number


def pattern(text):
    if not is_pattern(text):
        raise argparse.ArgumentTypeError(f"{text}: needs #### or %04d for the frame")
    return text


def add_job_options(parser):
    add = parser.add_argument
    add(
        "-i",
        "--input",
        required=True,
        type=pattern,
        metavar="PATTERN",
        help="renders, such as shot.####.exr or shot.%%04d.exr",
    )
    add("-o", "--output", required=True, type=pattern, metavar="PATTERN", help="results; missing folders are made")
    add("--frames", required=True, metavar="RANGES", help="frames, such as 1-10,20-40x2")
    add("--chunk", type=positive, metavar="N", help="frames of a task (default: as many as take --task-minutes)")
    add("--task-minutes", type=arguments.positive, default=10, metavar="M", help="minutes that a task takes")
    add(
        "--threads",
        type=positive,
        metavar="N",
        help="threads of a task (default: so that the tasks fill a node's memory)",
    )
    add("--memory", type=size, metavar="SIZE", help="memory of a task, such as 4G (default: by the measured model)")
    add(
        "--gpus",
        type=positive,
        default=0,
        metavar="N",
        help="graphics cards of a task, which --prior oidn uses (default: none)",
    )
    add(
        "--model",
        metavar="FILE",
        help="constants of your nodes, by tests/bench/farm_model.py (default: those of one machine)",
    )
    add_program(parser)
    add_verbosity(parser)


def parse_words(parser, words):
    """Parses the words before `--`. Those after it are options of `polyrecon denoise`."""
    at = words.index("--") if "--" in words else len(words)
    options = parser.parse_args(words[:at])
    options.options = words[at + 1 :]
    return options
