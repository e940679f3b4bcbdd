#!/usr/bin/env python3
"""Renders a .blend file with Cycles, taking samples only where the reconstruction needs them, and writes the clean picture.

examples:
  adaptive.py shot.blend -o shot.exr --budget-spp 64
  adaptive.py shot.blend -o 'out/shot_####.exr' --frames 1-10 --budget-seconds 120 --quality best
  adaptive.py shot.blend -o shot.exr --target 0.002 --bpy
  adaptive.py shot.blend -o shot.exr --budget-spp 128 --resume        # goes on after an interruption, or with more budget

The file is never changed and no script in it is run. Passes, merged picture, error map, sample maps, journal and
report.html stay in --passes-dir."""

import argparse
import pathlib
import sys

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    __package__ = "pipelines.blender"

from ..loop import adaptive, report
from ..loop.budget import Budget
from ..loop.errors import run_main
from ..loop.frames import frame_path
from ..loop.polyrecon_cli import Polyrecon
from ..loop.progress import Progress
from .options import add_common, frames_of, passes_of, positive, renderer_of


def arguments(words):
    parser = argparse.ArgumentParser(prog="polyrecon-blender", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_common(parser)
    budget = parser.add_mutually_exclusive_group(required=True)
    budget.add_argument("--budget-spp", type=positive, metavar="N", help="samples per pixel on average")
    budget.add_argument("--budget-seconds", type=positive, metavar="S", help="seconds of everything, for each frame")
    budget.add_argument("--target", type=positive, metavar="E", help="mean relative MSE of the result, as estimated")
    parser.add_argument("--first-pass", type=int, default=8, metavar="N", help="uniform samples to begin with: 4 or a multiple of 8 (8)")
    parser.add_argument("--max-rounds", type=int, default=8, metavar="N", help="most rounds of extra samples (8)")
    parser.add_argument("--quality", choices=adaptive.LAST_OVER_ROUND, default="standard", help="of the last reconstruction (standard)")
    parser.add_argument("--method", choices=("auto", "osl", "regions"), default="auto",
                        help="how extra samples are rendered: by a camera with a mask (Blender 5), or as rectangles (auto)")  # fmt: skip
    parser.add_argument("--resume", action="store_true", help="go on with the passes of an earlier run")
    options = parser.parse_args(words)
    if options.first_pass != 4 and (options.first_pass < 8 or options.first_pass % 8):
        parser.error("--first-pass: 4 or a multiple of 8")
    if options.budget_spp and options.budget_spp < options.first_pass:
        parser.error(f"--budget-spp {options.budget_spp:g} is less than --first-pass {options.first_pass}")
    return options


def work(words):
    options = arguments(words)
    frames = frames_of(options)
    polyrecon = Polyrecon(options.polyrecon)
    renderer = renderer_of(options, options.method)
    try:
        with Progress("none" if options.quiet else options.progress) as progress:
            for frame in frames:
                one_frame(options, renderer, polyrecon, frame, progress)
    finally:
        renderer.close()


def one_frame(options, renderer, polyrecon, frame, progress):
    output = frame_path(options.output, frame, bool(options.frames))
    status = options.scene.stat()
    settings = adaptive.Settings(
        output=output,
        passes=passes_of(options, output, frame),
        budget=Budget(options.budget_spp, options.budget_seconds, options.target),
        frame=frame,
        first_pass=options.first_pass,
        max_rounds=options.max_rounds,
        quality=options.quality,
        resume=options.resume,
        identity={"scene": str(options.scene.resolve()), "bytes": status.st_size, "changed": status.st_mtime_ns,
                  "visibility": options.visibility, "renderer": "Blender"},
    )  # fmt: skip
    result = adaptive.run(renderer, polyrecon, settings, progress)
    page = report.write(result, settings, polyrecon)
    if not options.quiet:
        print(report.text(result, settings, page))


def main(words=None):
    return run_main("polyrecon-blender", work, words)


if __name__ == "__main__":
    sys.exit(main())
