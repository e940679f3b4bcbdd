#!/usr/bin/env python3
"""Prints what denoising a shot costs on nodes of a given kind: a Markdown table out of the measured model."""

import argparse
import pathlib
import sys

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    __package__ = "pipelines.farm"

from ..common.errors import DriverError, ExitCode, run_main
from .plan import positive, size
from .requirements import Frame, Model, Node, threads_for

EXAMPLES = """\
examples:
  polyrecon-farm cost                                                      # 1000 frames of 4K
  polyrecon-farm cost --size 1920x1080 --frames 240 --node-cpus 32 --node-memory 128G --price 0.03
"""
QUALITIES = ("draft", "standard", "best")


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |")


def print_table(options):
    model = Model(options.model) if options.model else Model()
    try:
        width, height = (int(word) for word in options.size.lower().split("x"))
    except ValueError:
        raise DriverError(ExitCode.USAGE, f"--size {options.size}: write 3840x2160") from None
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
        core_hours = node_hours * node.cpus  # a node is paid whole
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


def arguments(words):
    parser = argparse.ArgumentParser(
        prog="polyrecon-farm cost",
        description=__doc__,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--size", default="3840x2160", metavar="WxH")
    add("--frames", type=positive, default=1000, metavar="N")
    add("--channels", type=positive, default=42, metavar="N", help="of a file, in all (default: 42)")
    add("--fit-channels", type=positive, default=41, metavar="N", help="that take part in the fit (default: 41)")
    add("--nodes", type=positive, default=10, metavar="N")
    add("--node-cpus", type=positive, default=64, metavar="N")
    add("--node-memory", type=size, default="256G", metavar="SIZE")
    add("--price", type=float, default=0.04, metavar="P", help="of a core-hour (default: 0.04)")
    add("--speed", type=float, default=1, metavar="F", help="of a node's core over that of the measured machine")
    add("--model", metavar="FILE", help="constants that tests/bench/farm_model.py measured on your nodes")
    return parser.parse_args(words)


def main(words=None):
    return run_main(
        "polyrecon-farm", lambda words: print_table(arguments(sys.argv[1:] if words is None else words)), words
    )


if __name__ == "__main__":
    sys.exit(main())
