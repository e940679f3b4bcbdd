"""Command line options that all drivers of a renderer have, and the frames that they name."""

import pathlib

from .frames import frame_path, parse_frames
from .polyrecon_cli import Polyrecon
from .progress import STYLES, Progress


def add_frame_arguments(parser):
    """What to write, for which frames, and how to tell of it."""
    parser.add_argument(
        "-o", "--output", required=True, metavar="OUT.exr", help="picture to write; #### or %%04d is the frame"
    )
    frames = parser.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=int, help="frame to render, in place of the scene's own")
    frames.add_argument("--frames", help="frames to render: 1-10,20-40x2")
    parser.add_argument("--polyrecon", metavar="PATH", help="polyrecon to run ($POLYRECON, else `polyrecon`)")
    parser.add_argument(
        "--passes-dir", type=pathlib.Path, metavar="DIR", help="for all that is made on the way (OUT.passes)"
    )
    parser.add_argument("--progress", choices=STYLES, default="auto", help="json: one object a line on standard error")
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")


def each_frame(options, renderer, work):
    """Calls work(frame, output, passes, polyrecon, progress) for every frame asked for: its picture and the folder of its
    passes. Closes the renderer."""
    try:
        frames = parse_frames(options.frames) if options.frames else [options.frame]
        polyrecon = Polyrecon(options.polyrecon)
        with Progress("none" if options.quiet else options.progress) as progress:
            for frame in frames:
                output = frame_path(options.output, frame, bool(options.frames))
                passes = options.passes_dir or output.with_suffix(".passes")
                if options.frames and options.passes_dir:
                    passes = passes / f"{frame:04d}"
                work(frame, output, passes, polyrecon, progress)
    finally:
        renderer.close()
