"""The report of a loop: a page, and a few lines for the terminal."""

import base64
import math
import os
import pathlib

import jinja2

from ..common.errors import DriverError
from ..common.files import write_text
from ..common.terminal import printable
from ..common.work_folder import WorkFolder
from .adaptive import NO_ERROR_LEFT
from .budget import CONVERGENCE_RATE
from .folder import PassFolder

TEMPLATE = pathlib.Path(__file__).with_name("report.html.j2")
FEW_SAMPLES = 64  # per pixel: up to here a network's picture is worth its seconds (docs/guide/second_opinion.md)
CURVE = {"width": 640, "height": 240, "margin": 48}  # Pixels


def lines(result, settings, verbose):
    """What is printed of a frame: what was rendered, what came of it, what would make it better. `verbose`: what was
    decided on the way, too."""
    audit, rounds, files = result.audit, result.state.rounds, settings.files
    frame = "" if files.number is None else f"frame {files.number}, "
    features = ", ".join(audit.features)
    found = [
        f"{files.output}: {frame}{audit.width} x {audit.height}, {result.renderer}, "
        f"{result.samples:.3g} samples per pixel"
        + (f" in {len(rounds)} rounds" if len(rounds) > 1 else "")
        + (f"; features: {features}" if features else "; no features"),
        f"  relative MSE {_error_text(result.noise)} before, {_error_text(result.error)} estimated after, "
        f"{_seconds_text(result.seconds)}; {result.why_ended or 'the budget is spent'}",
        f"  better: {_advice(result, settings)}",
    ]
    if not verbose:
        return found
    found += [
        f"  round {entry.round}: {entry.samples:.3g} spp, {entry.seconds:.1f} s, relMSE {_error_text(entry.error)}"
        for entry in rounds
    ]
    return [*found, *(f"  {line}" for line in audit.lines())]


def _advice(result, settings):
    """What would lower the error, as options of the driver."""
    budget, factor = settings.budget, 2 ** (1 / CONVERGENCE_RATE)
    if result.why_ended == NO_ERROR_LEFT:
        return "nothing, the picture has no noise left"
    if budget.samples:
        more = f"--budget-spp {factor * result.samples:.0f}"
    elif budget.seconds:
        more = f"--budget-seconds {factor * budget.seconds:.0f}"
    else:
        more = f"--target {budget.target / 2:.2g}"
    words = [f"{more} halves the error"]
    if settings.quality != "best":
        words.append(f"--quality {'best' if settings.quality == 'standard' else 'standard'}")
    if not settings.with_prior and result.samples <= FEW_SAMPLES:
        words.append("--with-prior, since the samples are few")
    return "; ".join(words)


def write(result, settings, polyrecon, pages):
    """Writes the report to each path of `pages`. It holds its pictures and loads nothing. Where these cannot be made, a
    note says so."""
    environment = jinja2.Environment(
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
        finalize=lambda value: printable(value) if isinstance(value, str) else value,
    )
    environment.filters["error_text"] = _error_text
    passes = PassFolder(settings.files.passes)
    rounds = result.state.rounds
    with WorkFolder("report") as folder:
        files = [_files_of(entry.round, passes) for entry in rounds]
        files.append([result.merged, settings.files.output, result.error_map])
        try:
            *pictures, final = _pictures(polyrecon, files, folder)
        except DriverError as error:  # The frame is finished, so it does not fail for a page's pictures.
            result.audit.notes.append(f"the report has no pictures: {error}")
            pictures, final = [None] * len(rounds), None
    page = environment.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        result=result,
        settings=settings,
        program=polyrecon.describe(),
        rounds=list(zip(rounds, pictures)),
        final=final,
        curve=_curve(result),
        size=CURVE,
    )
    for path in pages:
        write_text(path, page)


def _seconds_text(seconds):
    return f"{seconds:.1f} s" if seconds < 120 else f"{seconds / 60:.1f} min"


def _error_text(error):
    return "unknown" if error is None or not math.isfinite(error) else f"{error:.3g}"


def _files_of(number, passes):
    """The knowledge after a round, and the samples that followed."""
    following = passes.in_round(number + 1, "samples")
    files = [passes.in_round(number, name) for name in ("noisy", "clean", "error")]
    return [*files, following] if following.exists() else files


def _pictures(polyrecon, file_lists, folder):
    """A PNG in base64 for each list of files. As many programs run at once as there are processors."""
    targets = [folder / f"{number}.png" for number in range(len(file_lists))]
    words = [[*files, "-o", target] for files, target in zip(file_lists, targets)]
    for begin in range(0, len(words), step := os.cpu_count() or 1):
        polyrecon.run_side_by_side("preview", words[begin : begin + step])
    return [base64.b64encode(target.read_bytes()).decode() for target in targets]


def _curve(result):
    """Points of the estimated error against seconds, both logarithmic, in pixels of the drawing: [{x, y, label}]."""
    points = [(entry.seconds, entry.error) for entry in result.state.rounds] + [(result.seconds, result.error)]
    points = [(x, y) for x, y in points if y is not None and math.isfinite(y) and y > 0]
    across = _scaled([math.log(max(x, 1e-3)) for x, _ in points], CURVE["width"])
    upwards = _scaled([math.log(y) for _, y in points], CURVE["height"])
    return [
        {"x": round(left, 1), "y": round(CURVE["height"] - up, 1), "label": f"{x:.3g} s, {y:.3g}"}
        for (x, y), left, up in zip(points, across, upwards)
    ]


def _scaled(values, length):
    """Values as places between the margins of an axis."""
    if not values:
        return []
    low, high = min(values), max(values)
    scale = (length - 2 * CURVE["margin"]) / ((high - low) or 1)
    return [CURVE["margin"] + (value - low) * scale for value in values]
