#!/usr/bin/env python3
"""Prints what denoising a shot costs on nodes of a given kind, as a Markdown table. The figures come from the measured
model."""

import pathlib
import re
import sys

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.farm"

from ..common import arguments
from ..common.arguments import Parser
from ..common.denoise_defaults import QUALITIES
from ..common.errors import DriverError, ExitCode, run_main
from .job_options import positive, size
from .requirements import Frame, Model, Node, threads_for

EXAMPLES = """\
examples:
  %(prog)s                                                      # for 1000 frames of 4K
  %(prog)s --size 1920x1080 --frames 240 --node-cpus 32 --node-memory 128G --price 0.03
"""


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |")


def print_table(options):
    model = Model(options.model) if options.model else Model()
    found = re.fullmatch("([0-9]{1,9})x([0-9]{1,9})", options.size.lower())
    if not found:
        raise DriverError(ExitCode.USAGE, f"--size {options.size}: write it as 3840x2160")
    width, height = map(int, found.groups())
    frame = Frame(width, height, options.channels, options.fit_channels)
    node = Node(options.node_cpus, options.node_memory)
    row(
        "quality",
        "GB a task",
        "threads",
        "tasks a node",
        "frames/h and node",
        "core-hours",
        "hours",
        f"cost at {options.price}",
    )
    row("---", *["---:"] * 7)
    for quality in QUALITIES:
        request = model.request_bytes(frame, quality)
        threads = threads_for(request, [node])
        tasks = min(node.cpus // threads, node.memory // request)
        seconds = model.wall_seconds(frame, quality, threads) / options.speed
        per_hour = 3600 * tasks / seconds
        node_hours = options.frames / per_hour
        core_hours = node_hours * node.cpus  # whole nodes are paid
        row(
            quality,
            f"{request / 1e9:.1f}",
            threads,
            tasks,
            f"{per_hour:.0f}",
            f"{core_hours:.0f}",
            f"{node_hours / options.nodes:.1f}",
            f"{core_hours * options.price:.2f}",
        )


def options_of(words):
    parser = Parser("polyrecon-farm cost", description=__doc__, epilog=EXAMPLES)
    add = parser.add_argument
    add("--size", default="3840x2160", metavar="WxH", help="size of a frame")
    add("--frames", type=positive, default=1000, metavar="N", help="frames of the shot")
    add("--channels", type=positive, default=42, metavar="N", help="channels of a file")
    add("--fit-channels", type=positive, default=41, metavar="N", help="channels that take part in the fit")
    add("--nodes", type=positive, default=10, metavar="N", help="nodes that work on it")
    add("--node-cpus", type=positive, default=64, metavar="N", help="processors of a node")
    add("--node-memory", type=size, default="256G", metavar="SIZE", help="memory of a node")
    add("--price", type=float, default=0.04, metavar="P", help="price of a core-hour")
    add(
        "--speed",
        type=arguments.positive,
        default=1,
        metavar="F",
        help="speed of a node's core, relative to the measured machine",
    )
    add(
        "--model",
        metavar="FILE",
        help="constants of your nodes, by tests/bench/farm_model.py (default: those of one machine)",
    )
    return parser.parse_args(words)


def main(words=None):
    return run_main(
        "polyrecon-farm", lambda words: print_table(options_of(sys.argv[1:] if words is None else words)), words
    )


if __name__ == "__main__":
    sys.exit(main())
