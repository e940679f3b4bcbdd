"""The command line options of the adaptive loop, and the loop over the frames that they name."""

from ..common.arguments import positive
from ..common.command import each_frame
from ..common.denoise_defaults import DEFAULT_QUALITY, QUALITIES
from ..common.terminal import print_lines
from . import adaptive, report
from .budget import Budget
from .journal import HALVES

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
    parser.add_argument(
        "--max-rounds", type=int, default=8, metavar="N", help="limit of the rounds of extra samples (8)"
    )
    parser.add_argument(
        "--quality",
        choices=QUALITIES,
        default=DEFAULT_QUALITY,
        help=f"quality of the last reconstruction ({DEFAULT_QUALITY})",
    )
    parser.add_argument("--resume", action="store_true", help="continue with the passes of an earlier run")


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
            scene=identity.get("scene"),
        )
        result = adaptive.run(renderer, polyrecon, settings, progress)
        page = report.write(result, settings, polyrecon)
        if not options.quiet:
            print_lines(*report.lines(result, settings, page))

    each_frame(options, renderer, work)
