"""What the command lines of the drivers have in common, beside their renderer."""

import pathlib

from . import adaptive, report
from .arguments import positive
from .budget import Budget
from .frames import frame_path, parse_frames
from .polyrecon_cli import Polyrecon
from .progress import STYLES, Progress


def add_frame_arguments(parser):
    """What to write, for which frames, and how to tell of it."""
    parser.add_argument("-o", "--output", required=True, metavar="OUT.exr", help="picture to write; #### or %%04d is the frame")
    frames = parser.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=int, help="frame to render, in place of the scene's own")
    frames.add_argument("--frames", help="frames to render: 1-10,20-40x2")
    parser.add_argument("--polyrecon", metavar="PATH", help="polyrecon to run ($POLYRECON, else `polyrecon`)")
    parser.add_argument("--passes-dir", type=pathlib.Path, metavar="DIR", help="for all that is made on the way (OUT.passes)")
    parser.add_argument("--progress", choices=STYLES, default="auto", help="json: one object a line on standard error")
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")


def add_loop_arguments(parser, first_pass, first_pass_help):
    """The options of the loop, for a driver whose first pass has so many samples."""
    budget = parser.add_mutually_exclusive_group(required=True)
    budget.add_argument("--budget-spp", type=positive, metavar="N", help="samples per pixel on average")
    budget.add_argument("--budget-seconds", type=positive, metavar="S", help="seconds of everything, for each frame")
    budget.add_argument("--target", type=positive, metavar="E", help="mean relative MSE of the result, as estimated")
    parser.add_argument("--first-pass", type=int, default=first_pass, metavar="N", help=first_pass_help)
    parser.add_argument("--max-rounds", type=int, default=8, metavar="N", help="most rounds of extra samples (8)")
    parser.add_argument("--quality", choices=adaptive.LAST_OVER_ROUND, default="standard", help="of the last reconstruction (standard)")
    parser.add_argument("--resume", action="store_true", help="go on with the passes of an earlier run")


def check_budget(parser, options):
    if options.budget_spp and options.budget_spp < options.first_pass:
        parser.error(f"--budget-spp {options.budget_spp:g} is less than --first-pass {options.first_pass}")


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


def run_frames(options, renderer, identity):
    """The loop over all frames that the options ask for. `identity` tells what the passes are of, beside the scene file
    itself: other passes may not go on with them."""
    status = pathlib.Path(options.scene).stat()
    identity = {
        "scene": str(pathlib.Path(options.scene).resolve()),
        "bytes": status.st_size,
        "changed": status.st_mtime_ns,
        **identity,
    }

    def work(frame, output, passes, polyrecon, progress):
        settings = adaptive.Settings(
            output=output,
            passes=passes,
            budget=Budget(options.budget_spp, options.budget_seconds, options.target),
            frame=frame,
            first_pass=options.first_pass,
            max_rounds=options.max_rounds,
            quality=options.quality,
            resume=options.resume,
            identity=identity,
        )
        result = adaptive.run(renderer, polyrecon, settings, progress)
        page = report.write(result, settings, polyrecon)
        if not options.quiet:
            print(report.text(result, settings, page))

    each_frame(options, renderer, work)
