#!/usr/bin/env python3
"""Renders a .blend file with Cycles, takes samples where the reconstruction needs them, and writes the clean picture.

examples:
  %(prog)s shot.blend -o shot.exr --budget-spp 64
  %(prog)s shot.blend -o 'out/shot_####.exr' --frames 1-10 --budget-seconds 1200 --quality best
  %(prog)s shot.blend -o shot.exr --target 0.002 --with-prior --error-map error.exr --report shot.html
  %(prog)s shot.blend -o shot.exr --budget-spp 64 --keep-passes
  %(prog)s shot.blend -o shot.exr --budget-spp 128 --keep-passes --resume    # more samples; also after an interruption

The .blend file is not changed and none of its scripts is run."""

import pathlib
import sys

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.blender"

from ..common.modules import RENDERING, required

with required("polyrecon-blender", RENDERING):
    from ..common.arguments import Parser
    from ..common.errors import run_main
    from ..loop import command
    from .options import add_common, renderer_of


def arguments(words):
    parser = Parser("polyrecon-blender", description=__doc__)
    add_common(parser)
    command.add_loop_arguments(parser, 8, "uniform samples of the first pass: 4 or a multiple of 8")
    parser.add_argument(
        "--method",
        choices=("auto", "osl", "regions"),
        default="auto",
        help="way of extra samples: osl, a camera with a mask (Blender 5), or regions, rectangles",
    )
    parser.add_argument(
        "--own-passes",
        choices=("first", "full"),
        default="first",
        help="samples of further passes that the file has switched on, such as Cryptomatte: first, those of the first "
        "part, or full, the scene's, in a render of their own at the end, which no limit counts",
    )
    options = parser.parse_args(words)
    if options.first_pass != 4 and (options.first_pass < 8 or options.first_pass % 8):
        parser.error(f"--first-pass {options.first_pass}: must be 4 or a multiple of 8")
    command.check_budget(parser, options)
    return options


def work(words):
    options = arguments(words)
    command.run_frames(
        "polyrecon-blender",
        options,
        renderer_of(options, options.method, options.own_passes),
        {
            "renderer": "Blender",
            "scene": str(options.scene.resolve()),
            "visibility": options.visibility,
            "view_layer": options.view_layer,
            "device": options.device,
            "own_passes": options.own_passes,
        },
    )


def main(words=None):
    return run_main("polyrecon-blender", work, words)


if __name__ == "__main__":
    sys.exit(main())
