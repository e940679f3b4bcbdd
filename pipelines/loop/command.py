"""The command line options of the adaptive loop, and the loop over the frames that they name."""

import contextlib
import pathlib
import sys

from ..common import exr, outputs
from ..common.arguments import positive
from ..common.command import Notes, check_outputs, found_polyrecon, frames_of, progress_of
from ..common.denoise_defaults import DEFAULT_QUALITY, ON_MISS, QUALITIES
from ..common.errors import DriverError, ExitCode
from ..common.frame_names import is_pattern, without_number
from ..common.terminal import print_lines, size_text
from . import adaptive, prior, report, shot, shot_report
from .budget import Budget
from .folder import PassFolder
from .frame import Settings
from .journal import HALVES
from .reconstruction import SETTINGS_ATTRIBUTE

MIN_FIRST_PASS = 2 * len(HALVES)


def add_loop_arguments(parser, first_pass, first_pass_help):
    """Adds the options of the loop. first_pass is the driver's default number of uniform samples."""
    budget = parser.add_mutually_exclusive_group(required=True)
    budget.add_argument(
        "--budget-spp", type=positive, metavar="N", help="samples per pixel, mean of all pixels of all --frames"
    )
    budget.add_argument(
        "--budget-seconds", type=positive, metavar="S", help="seconds from start to result, for all --frames together"
    )
    budget.add_argument(
        "--target", type=positive, metavar="E", help="estimated relative MSE, mean of all pixels of all --frames"
    )
    parser.add_argument(
        "--on-miss",
        choices=ON_MISS,
        default=ON_MISS[0],
        help="where --target or --budget-seconds cannot be reached, the best that can be done is written; keep ends "
        "with code 0, fail with 8",
    )
    parser.add_argument("--first-pass", type=int, default=first_pass, metavar="N", help=first_pass_help)
    parser.add_argument("--max-rounds", type=int, default=8, metavar="N", help="limit of the rounds of extra samples")
    parser.add_argument(
        "--quality", choices=QUALITIES, default=DEFAULT_QUALITY, help="quality of the last reconstruction"
    )
    parser.add_argument(
        "--with-prior", action="store_true", help="use Open Image Denoise's picture where it is better (--prior oidn)"
    )
    parser.add_argument("--error-map", metavar="FILE.exr", help="write the estimated error of each pixel")
    parser.add_argument(
        "--report",
        metavar="FILE.html",
        help="write a page with pictures and figures of every round; of several frames, one of the shot too",
    )
    outputs.add_contents(parser)
    parser.add_argument(
        "--keep-passes",
        action="store_true",
        help="keep the folder of passes, which --resume continues from; --outputs input then has the features, and "
        "variance and halves of all layers",
    )
    parser.add_argument(
        "--resume", action="store_true", help="continue with the passes of an earlier run; what is finished is skipped"
    )


def check_budget(parser, options):
    """Ends the program with exit code 2 where the budget or the first pass is impossible. Each half needs two samples,
    since variance is measured by their difference. A driver may demand more of --first-pass."""
    if options.first_pass < MIN_FIRST_PASS or options.first_pass % len(HALVES):
        parser.error(f"--first-pass {options.first_pass}: must be an even number from {MIN_FIRST_PASS} on")
    if options.budget_spp and options.budget_spp < options.first_pass:
        parser.error(f"--budget-spp {options.budget_spp:g} is less than --first-pass {options.first_pass}")


def run_frames(program, options, renderer, identity):
    """Runs the loop for the frame of the options, or for several frames as a shot.

    program: the name of the driver in messages.
    identity: every setting that changes a sample, with a name; `scene` is the path of a file. --resume continues only
    passes of the same identity, frame and --first-pass, and of the same inputs (Audit.inputs)."""
    try:
        frames = frames_of(options, of_all=("report",))
        numbers = tuple(frame.number for frame in frames) if len(frames) > 1 else ()
        page = shot_page(options.report, numbers)
        files = [path for frame in frames for path in frame.outputs] + ([page] if page else [])
        check_outputs(files, options.overwrite or options.resume)
        polyrecon = found_polyrecon(options)
        if options.with_prior:
            prior.check(polyrecon)
        files = ["-i", frames[0].passes / "merged.exr", "-o", frames[0].output]
        polyrecon.check_options("denoise", *files, "--outputs", options.outputs)
        settings = [
            Settings(
                files=frame,
                budget=Budget(options.budget_spp, options.budget_seconds, options.target),
                first_pass=options.first_pass,
                max_rounds=options.max_rounds,
                quality=options.quality,
                resume=options.resume,
                with_prior=options.with_prior,
                keep_passes=options.keep_passes,
                contents=options.outputs,
                compression=options.compression,
                dwa_level=options.dwa_level,
                identity=identity,
                scene=identity.get("scene"),
                shot=numbers,
            )
            for frame in frames
        ]
        notes = Notes(options.quiet)
        with progress_of(options, len(frames), together=bool(numbers)) as progress:
            progress.begin_frame()
            arguments = (options.verbose, renderer, polyrecon, progress, notes.tell)
            missed = failed = ""
            if options.resume and is_finished(settings, options.overwrite):
                said = [f"{entry.files.output}: finished already: skipped" for entry in settings]
            else:
                said, missed = whole_shot(settings, page, *arguments) if numbers else one_frame(settings[0], *arguments)
                failed = missed if options.on_miss == "fail" else ""
                said += [] if failed else end_of_passes(settings)
        if not options.quiet:
            print_lines(*said)
        if failed:
            with advice_of_passes(frames):
                raise DriverError(ExitCode.MISSED, failed)
        if missed:
            print_lines(f"{program}: {missed}", file=sys.stderr)
    finally:
        renderer.close()


def shot_page(report_file, numbers):
    """The path of a shot's page; None without --report and for a frame by itself."""
    if not report_file or not numbers:
        return None
    return pathlib.Path(without_number(report_file, "shot") if is_pattern(report_file) else report_file)


def is_finished(settings, overwrite):
    """Whether an earlier run has finished all frames and removed the passes of one at least; those of the others are
    removed then. Results of other settings are refused unless `overwrite`."""
    gone = [entry for entry in settings if not PassFolder(entry.files.passes).journal.exists()]
    made = [entry for entry in gone if entry.files.output.exists()]
    if not made:
        return False
    strange = [entry for entry in made if not is_made_by(entry)]
    if not strange and all(is_made_by(entry) for entry in settings):
        for entry in settings:
            if entry not in gone:
                remove_passes(entry.files)
        return True
    if overwrite:
        return False
    if strange:
        raise DriverError(
            ExitCode.USAGE,
            f"{strange[0].files.output}: is there, but not from this scene with these options, and its passes are not "
            f"in {strange[0].files.passes}: add --overwrite to render it again",
        )
    raise DriverError(
        ExitCode.USAGE,
        f"{made[0].files.output}: is finished and its passes are gone, but other frames of the shot are not finished: "
        "add --overwrite to render it again",
    )


def is_made_by(settings):
    """Whether the output is there and is a result of these settings."""
    output = settings.files.output
    return output.exists() and exr.metadata(output).get(SETTINGS_ATTRIBUTE) == settings.digest()


def remove_passes(files):
    """Removes the passes of a frame, and its folders if nothing else is in them."""
    folder = PassFolder(files.passes)
    with folder.claimed():
        folder.remove()
    files.remove_empty_folders()


def one_frame(settings, verbose, renderer, polyrecon, progress, tell):
    """Renders a frame; returns the lines about it, and what it missed or ''. tell: gets notes as they are known."""
    folder = PassFolder(settings.files.passes)
    with advice_of_passes([settings.files]):
        result = adaptive.run(renderer, polyrecon, settings, progress, tell)
    pages = [page for page in (settings.files.report, folder.report if settings.keep_passes else None) if page]
    if pages:
        report.write(result, settings, polyrecon, pages)
    tell(result.audit.notes)
    missed = report.missed(result, settings.budget)
    said = report.lines(result, settings, verbose, polyrecon)
    return said, f"{settings.files.output}: {missed}" if missed else ""


def whole_shot(settings, page, verbose, renderer, polyrecon, progress, tell):
    """Renders the frames of a shot; returns as one_frame does. page: path of the shot's page, or None."""
    with advice_of_passes([entry.files for entry in settings]):
        result = shot.run(renderer, polyrecon, settings, progress, tell)
    write_pages(result, page, polyrecon)
    for _, frame in result.frames:
        tell(frame.audit.notes)
    missed = report.missed(result, result.budget)
    said = shot_report.lines(result, verbose, polyrecon)
    return said, f"shot of {len(settings)} frames: {missed}" if missed else ""


def end_of_passes(settings):
    """Removes the passes of finished frames; if they stay, returns the line about them."""
    if settings[0].keep_passes:
        return [f"  {passes_text([entry.files for entry in settings])}"]
    for entry in settings:
        remove_passes(entry.files)
    return []


@contextlib.contextmanager
def advice_of_passes(files):
    """A context whose errors say where the passes of these frames are, if there are any."""
    try:
        yield
    except BaseException as error:
        if any(PassFolder(frame.passes).journal.exists() for frame in files):
            error.advice = f"; {passes_text(files)}"
        raise


def write_pages(result, page, polyrecon):
    """The pages of the frames, which show the passes, and that of the shot, which links them."""
    for settings, frame in result.frames:
        in_folder = PassFolder(settings.files.passes).report if settings.keep_passes else None
        if pages := [path for path in (settings.files.report, in_folder) if path]:
            report.write(frame, settings, polyrecon, pages)
    if page:
        shot_report.write(result, polyrecon, page)


def passes_text(files):
    """The place, size and use of the passes of these frames, and how to remove them."""
    folders = [frame.passes for frame in files if frame.passes.exists()]
    of_all = files[0].passes_of_all
    if of_all and set(of_all.iterdir()) == set(folders):
        folders = [of_all]
    size = size_text(sum(PassFolder(folder).size for folder in folders))
    return (
        f"passes in {of_all or folders[0]} ({size}): --resume continues with them, `{outputs.removal(folders)}` "
        "removes them"
    )
