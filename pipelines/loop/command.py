"""The command line options of the adaptive loop, and the loop over the frames that they name."""

import shlex

from ..common import exr, outputs
from ..common.arguments import positive
from ..common.command import Notes, each_frame
from ..common.denoise_defaults import DEFAULT_QUALITY, QUALITIES
from ..common.errors import DriverError, ExitCode
from ..common.terminal import print_lines
from . import adaptive, prior, report
from .budget import Budget
from .folder import PassFolder
from .journal import HALVES
from .reconstruction import SETTINGS_ATTRIBUTE

MIN_FIRST_PASS = 2 * len(HALVES)


def add_loop_arguments(parser, first_pass, first_pass_help):
    """Adds the options of the loop. first_pass is the driver's default number of uniform samples."""
    budget = parser.add_mutually_exclusive_group(required=True)
    budget.add_argument("--budget-spp", type=positive, metavar="N", help="samples per pixel on average")
    budget.add_argument(
        "--budget-seconds", type=positive, metavar="S", help="seconds for each frame, from start to result"
    )
    budget.add_argument("--target", type=positive, metavar="E", help="estimated mean relative MSE of the result")
    parser.add_argument("--first-pass", type=int, default=first_pass, metavar="N", help=first_pass_help)
    parser.add_argument("--max-rounds", type=int, default=8, metavar="N", help="limit of the rounds of extra samples")
    parser.add_argument(
        "--quality", choices=QUALITIES, default=DEFAULT_QUALITY, help="quality of the last reconstruction"
    )
    parser.add_argument(
        "--with-prior", action="store_true", help="use Open Image Denoise's picture where it is better (--prior oidn)"
    )
    parser.add_argument("--error-map", metavar="FILE.exr", help="write the estimated error of each pixel")
    parser.add_argument("--report", metavar="FILE.html", help="write a page with pictures and figures of every round")
    outputs.add_encoding(parser)
    parser.add_argument(
        "--keep-passes",
        action="store_true",
        help="keep the folder of passes, which --resume continues from; the result has the layers of the features, "
        "their variance and halves too",
    )
    parser.add_argument(
        "--resume", action="store_true", help="continue with the passes of an earlier run; finished frames are skipped"
    )


def check_budget(parser, options):
    """Ends the program with exit code 2 where the budget or the first pass is impossible. Each half needs two samples,
    since variance is measured by their difference. A driver may demand more of --first-pass."""
    if options.first_pass < MIN_FIRST_PASS or options.first_pass % len(HALVES):
        parser.error(f"--first-pass {options.first_pass}: must be an even number from {MIN_FIRST_PASS} on")
    if options.budget_spp and options.budget_spp < options.first_pass:
        parser.error(f"--budget-spp {options.budget_spp:g} is less than --first-pass {options.first_pass}")


def run_frames(options, renderer, identity):
    """Runs the loop for every frame of the options.

    identity: every setting that changes a sample, with a name; `scene` is the path of a file. --resume continues only
    passes of the same identity, frame and --first-pass, and of the same inputs (Audit.inputs)."""

    def work(frame, polyrecon, progress):
        settings = adaptive.Settings(
            files=frame,
            budget=Budget(options.budget_spp, options.budget_seconds, options.target),
            first_pass=options.first_pass,
            max_rounds=options.max_rounds,
            quality=options.quality,
            resume=options.resume,
            with_prior=options.with_prior,
            keep_passes=options.keep_passes,
            compression=options.compression,
            dwa_level=options.dwa_level,
            identity=identity,
            scene=identity.get("scene"),
        )
        if options.resume and is_finished(settings, options.overwrite):
            said = [f"{frame.output}: finished already: skipped"]
        else:
            said = one_frame(settings, options.verbose, renderer, polyrecon, progress, notes.tell)
        if not options.quiet:
            print_lines(*said)

    notes = Notes(options.quiet)
    if options.with_prior:
        prior.check(options.polyrecon)
    each_frame(options, renderer, work, may_exist=options.resume)


def is_finished(settings, overwrite):
    """Whether an earlier run has finished a frame and removed its passes. A result of other settings is refused unless
    `overwrite`."""
    output, folder = settings.files.output, PassFolder(settings.files.passes)
    if folder.journal.exists() or not output.exists():
        return False
    if exr.metadata(output).get(SETTINGS_ATTRIBUTE) == settings.digest():
        return True
    if overwrite:
        return False
    raise DriverError(
        ExitCode.USAGE,
        f"{output}: is there, but not from this scene with these options, and its passes are not in {folder.path}: "
        "add --overwrite to render it again",
    )


def one_frame(settings, verbose, renderer, polyrecon, progress, tell):
    """Renders a frame; returns the lines about it. tell: gets notes as they are known."""
    folder = PassFolder(settings.files.passes)
    try:
        result = adaptive.run(renderer, polyrecon, settings, progress, tell)
    except BaseException as error:
        if folder.journal.exists():
            error.advice = f"; {passes_text(folder)}"
        raise
    pages = [page for page in (settings.files.report, folder.report if settings.keep_passes else None) if page]
    if pages:
        report.write(result, settings, polyrecon, pages)
    tell(result.audit.notes)
    said = report.lines(result, settings, verbose)
    if settings.keep_passes:
        return [*said, f"  {passes_text(folder)}"]
    with folder.claimed():
        folder.remove()
    return said


def passes_text(folder):
    """The place, size and use of the render passes, and how to remove them."""
    words = ["rm", "-r", *(["--"] if str(folder.path).startswith("-") else []), str(folder.path)]
    size = outputs.size_text(folder.size)
    return f"passes in {folder.path} ({size}): --resume continues with them, `{shlex.join(words)}` removes them"
