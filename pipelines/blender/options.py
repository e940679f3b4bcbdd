"""What the commands of this folder have in common."""

import argparse
import pathlib

from ..loop.errors import DriverError, ExitCode
from ..loop.frames import parse_frames
from ..loop.progress import STYLES
from .renderer import BlenderRenderer


def positive(word):
    value = float(word)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{word}: not above 0")
    return value


def add_common(parser):
    parser.add_argument("scene", type=pathlib.Path, metavar="SCENE.blend")
    parser.add_argument("-o", "--output", required=True, metavar="OUT.exr", help="file to write; #### or %%04d is the frame")
    frames = parser.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=int, help="frame to render, in place of the file's current one")
    frames.add_argument("--frames", help="frames to render: 1-10,20-40x2")
    parser.add_argument("--visibility", choices=("shadow", "ambient-occlusion", "none"), default="none",
                        help="pass to render as the feature of that name (none)")  # fmt: skip
    blender = parser.add_mutually_exclusive_group()
    blender.add_argument("--blender", metavar="PATH", help="Blender to run ($BLENDER, else `blender`)")
    blender.add_argument("--bpy", action="store_const", const="bpy", dest="blender", help="use the module bpy of this Python")
    parser.add_argument("--polyrecon", metavar="PATH", help="polyrecon to run ($POLYRECON, else `polyrecon`)")
    parser.add_argument("--passes-dir", type=pathlib.Path, metavar="DIR", help="for all that is made on the way (OUT.passes)")
    parser.add_argument("--pass-timeout", type=positive, default=3600, metavar="S", help="a pass that takes longer has hung (3600)")
    parser.add_argument("--progress", choices=STYLES, default="auto", help="json: one object a line on standard error")
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")


def frames_of(options):
    return parse_frames(options.frames) if options.frames else [options.frame]


def passes_of(options, output, frame):
    """The folder of one frame's passes."""
    if not options.passes_dir:
        return output.with_suffix(".passes")
    return options.passes_dir / f"{frame:04d}" if options.frames else options.passes_dir


def renderer_of(options, method="auto"):
    if not options.scene.is_file():
        raise DriverError(ExitCode.MISSING, f"{options.scene}: no such file")
    visibility = None if options.visibility == "none" else options.visibility
    return BlenderRenderer(options.scene, options.blender, method, visibility, options.pass_timeout)
