"""The command line options of every driver of a renderer, and the loop over the frames that they name."""

import pathlib

from .errors import DriverError, ExitCode
from .frame_names import frame_path, is_pattern, parse_ranges
from .polyrecon_cli import Polyrecon
from .progress import STYLES, Progress


def add_frame_arguments(parser):
    """Adds the options for output, frames and progress."""
    parser.add_argument(
        "-o", "--output", required=True, metavar="OUT.exr", help="EXR file to write; #### or %%04d stands for the frame"
    )
    frames = parser.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=int, help="frame to render (default: the scene's current frame)")
    frames.add_argument("--frames", help="frames to render: 1-10,20-40x2")
    parser.add_argument("--polyrecon", metavar="PATH", help="the program (default: $POLYRECON, else `polyrecon`)")
    parser.add_argument(
        "--passes-dir",
        type=pathlib.Path,
        metavar="DIR",
        help="folder for passes and other intermediate files (default: OUT.passes)",
    )
    parser.add_argument(
        "--progress", choices=STYLES, default="auto", help="json: one JSON object a line on standard error"
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")


def each_frame(options, renderer, work):
    """Calls work(frame, output, passes, polyrecon, progress) for every frame of the options, then closes the renderer.

    output is the path of the frame's picture and passes the folder of its passes. frame is None for the scene's current
    frame."""
    try:
        frames = parse_ranges(options.frames) if options.frames else [options.frame]
        polyrecon = Polyrecon(options.polyrecon)
        with Progress("none" if options.quiet else options.progress) as progress:
            for frame in frames:
                output = _output_of(options, frame)
                passes = options.passes_dir or output.with_suffix(".passes")
                if options.frames and options.passes_dir:
                    passes = passes / frame_path("####", frame)
                work(frame, output, passes, polyrecon, progress)
    finally:
        renderer.close()


def _output_of(options, frame):
    """The path of one frame's picture. A single frame needs no place for its number."""
    if frame is not None and is_pattern(options.output):
        return pathlib.Path(frame_path(options.output, frame))
    if options.frames:
        raise DriverError(ExitCode.USAGE, f"-o {options.output}: several frames need #### or %04d in the file's name")
    return pathlib.Path(options.output)
