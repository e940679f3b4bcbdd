"""The command line options of every driver of a renderer, and the loop over the frames that they name."""

import contextlib
import dataclasses
import pathlib
from typing import Optional

from . import outputs
from .arguments import add_program, add_verbosity
from .errors import DriverError, ExitCode
from .frame_names import frame_path, is_pattern, parse_ranges, passes_of_all, passes_of_frame
from .polyrecon_cli import Polyrecon
from .progress import STYLES, Progress
from .terminal import print_lines

# The options that name files to write, and their endings. Not every driver has all of them.
OUTPUTS = {"output": ".exr", "error_map": ".exr", "report": ".html"}


@dataclasses.dataclass(frozen=True)
class Frame:
    """The files of one frame."""

    number: Optional[int]  # None: the scene's current frame
    passes: pathlib.Path  # Folder of its passes
    output: pathlib.Path
    error_map: Optional[pathlib.Path] = None
    report: Optional[pathlib.Path] = None
    passes_of_all: Optional[pathlib.Path] = None  # The folder of the passes of all --frames; None: a frame by itself

    def remove_empty_folders(self):
        """Removes the folders of passes in which nothing is left."""
        for folder in filter(None, (self.passes, self.passes_of_all)):
            with contextlib.suppress(OSError):
                folder.rmdir()

    @property
    def outputs(self):
        """The files that the user named."""
        return [path for name in OUTPUTS if (path := getattr(self, name))]


def add_output_arguments(parser):
    """Adds the options for the picture and for what is printed."""
    parser.add_argument(
        "-o", "--output", required=True, metavar="OUT.exr", help="EXR file to write; #### or %%04d stands for the frame"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace files that exist already")
    add_verbosity(parser)


def add_frame_arguments(parser):
    """Adds the options for output, frames and progress."""
    add_output_arguments(parser)
    frames = parser.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=int, metavar="N", help="frame to render (default: the scene's current frame)")
    frames.add_argument("--frames", metavar="RANGES", help="frames to render: 1-10,20-40x2")
    add_program(parser)
    parser.add_argument(
        "--passes-dir",
        type=pathlib.Path,
        metavar="DIR",
        help="folder for passes and other intermediate files, with one for each of several frames in it (default: "
        "OUT.passes)",
    )
    parser.add_argument(
        "--progress",
        choices=STYLES,
        default="auto",
        help="auto: a bar on a terminal, else a line a minute; json: one JSON object a line on standard error",
    )


class Notes:
    """Prints each note once, although every frame has it."""

    def __init__(self, quiet):
        self.quiet, self.printed = quiet, set()

    def tell(self, notes):
        for note in notes:
            if not self.quiet and note not in self.printed:
                print_lines(f"note: {note}")
            self.printed.add(note)


def each_frame(options, renderer, work):
    """Calls work(frame, polyrecon, progress) for the Frame of every frame of the options, then closes the renderer."""
    try:
        frames = frames_of(options)
        check_outputs([path for frame in frames for path in frame.outputs], options.overwrite)
        polyrecon = found_polyrecon(options)
        with progress_of(options, len(frames)) as progress:
            for frame in frames:
                progress.begin_frame()
                work(frame, polyrecon, progress)
    finally:
        renderer.close()


def frames_of(options, of_all=()):
    """The Frame of every frame of the options. of_all: outputs whose name may lack a place for the number, as there is
    one file for all frames; a Frame does not have such a file."""
    numbers = parse_ranges(options.frames) if options.frames else [options.frame]
    return [_frame_of(options, number, of_all if len(numbers) > 1 else ()) for number in numbers]


def check_outputs(files, may_exist):
    """Refuses files that cannot be written, before any work. may_exist: whether they may be there already."""
    outputs.check_new(files, may_exist)
    outputs.check_writable(files)


def found_polyrecon(options):
    """The program, which runs."""
    polyrecon = Polyrecon(options.polyrecon)
    described = polyrecon.describe()  # It fails where the program does not run.
    if options.verbose:
        print_lines(described)
    return polyrecon


def progress_of(options, frames, together=False):
    return Progress("none" if options.quiet else options.progress, frames, together)


def _frame_of(options, number, of_all):
    """The files of one frame. A single frame needs no place for its number."""
    named = {name: path for name in OUTPUTS if (path := getattr(options, name, None))}
    paths = {}
    for name, path in named.items():
        outputs.check_ending(path, OUTPUTS[name])
        if number is not None and is_pattern(path):
            path = frame_path(path, number)
        elif name in of_all:
            continue
        elif options.frames:
            option = "-o" if name == "output" else f"--{name.replace('_', '-')}"
            raise DriverError(ExitCode.USAGE, f"{option} {path}: several frames need #### or %04d in the file's name")
        paths[name] = pathlib.Path(path)
    if not options.frames:
        return Frame(number, options.passes_dir or paths["output"].with_suffix(".passes"), **paths)
    of_all = options.passes_dir or passes_of_all(options.output)
    return Frame(number, passes_of_frame(of_all, number), **paths, passes_of_all=of_all)
