#!/usr/bin/env python3
"""Renders a POV-Ray scene, takes samples where the reconstruction needs them, and writes the clean picture.

examples:
  %(prog)s scene.pov -o scene.exr --budget-spp 64 -- +W640 +H360
  %(prog)s scene.pov -o 'out/scene_####.exr' --frames 1-10 --budget-seconds 1200 -- scene.ini +KFF10
  %(prog)s scene.pov -o scene.exr --target 0.001 --error-map error.exr --report scene.html -- scene.ini
  %(prog)s scene.pov -o scene.exr --budget-spp 64 --keep-passes -- +W640 +H360
  %(prog)s scene.pov -o scene.exr --budget-spp 128 --keep-passes --resume -- +W640 +H360   # more samples

The words after -- are options of POV-Ray. The scene's files are not changed."""

if not __package__:  # run as a script from a checkout
    import pathlib
    import sys

    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.povray"

import pathlib
import sys

from ..common.modules import RENDERING, required

with required("polyrecon-povray", RENDERING):
    from ..common.arguments import Parser
    from ..common.command import add_frame_arguments
    from ..common.errors import DriverError, ExitCode, run_main
    from ..loop import command
    from .render_passes import add_povray_arguments, split_words
    from .renderer import PovrayRenderer


def main(words=None):
    return run_main("polyrecon-povray", _main, words)


def _main(words):
    words, povray_options = split_words(words)
    options = _arguments(words)
    if not options.scene.is_file():
        raise DriverError(ExitCode.MISSING, f"{options.scene}: no such scene")
    renderer = PovrayRenderer(
        options.scene, povray_options, options.povray, options.pass_timeout, options.first_pass, options.camera
    )
    command.run_frames(
        "polyrecon-povray",
        options,
        renderer,
        {
            "renderer": "POV-Ray",
            "scene": str(options.scene.resolve()),
            "options": povray_options,
            "camera": options.camera,
        },
    )


def _arguments(words):
    parser = Parser(
        "polyrecon-povray",
        usage="%(prog)s SCENE.pov -o OUT.exr (--budget-spp N | --budget-seconds S | --target E) [options] "
        "[-- POV-Ray's options]",
        description=__doc__,
    )
    parser.add_argument("scene", type=pathlib.Path, metavar="SCENE.pov", help="the scene; it is never changed")
    add_frame_arguments(parser)
    command.add_loop_arguments(parser, 16, "subpixels of the first pass: 4, 16, 36 or 64")
    add_povray_arguments(parser)
    options = parser.parse_args(words)
    command.check_budget(parser, options)
    return options


if __name__ == "__main__":
    sys.exit(main())
