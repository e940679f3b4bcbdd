"""The options that the commands of this folder have in common."""

import pathlib

from ..common.arguments import add_pass_timeout
from ..common.command import add_frame_arguments
from ..common.errors import DriverError, ExitCode
from .renderer import BlenderRenderer


def add_common(parser):
    """Adds the options for scene, frames, passes and Blender."""
    parser.add_argument("scene", type=pathlib.Path, metavar="SCENE.blend", help="the scene; it is never changed")
    add_frame_arguments(parser)
    parser.add_argument(
        "--view-layer", metavar="NAME", help="view layer to render (default: the first that is switched on)"
    )
    parser.add_argument(
        "--visibility",
        choices=("shadow", "ambient-occlusion", "none"),
        default="none",
        help="pass that is the feature `visibility`",
    )
    blender = parser.add_mutually_exclusive_group()
    blender.add_argument("--blender", metavar="PATH", help="Blender (default: $BLENDER, else `blender`)")
    blender.add_argument(
        "--bpy", action="store_const", const="bpy", dest="blender", help="use the module bpy of this Python as Blender"
    )
    parser.add_argument(
        "--device",
        choices=("auto", "cpu", "gpu"),
        default="auto",
        help="what Cycles renders on: auto: graphics cards if the scene renders on the GPU and there is one",
    )
    add_pass_timeout(parser, 3600)


def renderer_of(options, method="auto", own_passes="first"):
    """The BlenderRenderer of the options."""
    if not options.scene.is_file():
        raise DriverError(ExitCode.MISSING, f"{options.scene}: no such file")
    visibility = None if options.visibility == "none" else options.visibility
    return BlenderRenderer(
        options.scene,
        options.blender,
        method,
        visibility,
        options.pass_timeout,
        options.view_layer,
        options.device,
        own_passes,
    )
