"""The report of a loop: a page, and a few lines for the terminal."""

import json
import math
import pathlib

import jinja2

from ..common.errors import DriverError
from ..common.files import write_text
from ..common.terminal import printable
from ..common.work_folder import WorkFolder
from . import prior
from .budget import CONVERGENCE_RATE
from .folder import PassFolder
from .frame import MAX_ROUNDS, NO_ERROR_LEFT

TEMPLATE = pathlib.Path(__file__).with_name("report.html.j2")
LATE_SHARE = 0.1  # Share of --budget-seconds by which a result may be late: its last steps are predicted.
FEW_SAMPLES = 64  # per pixel; with more, --with-prior does not pay (docs/guide/adaptive.md)
CURVE = {"width": 1000, "height": 300, "left": 74, "right": 984, "top": 14, "bottom": 250}  # Pixels


def lines(result, settings, verbose, polyrecon):
    """The lines about a frame: what was rendered, what came of it, what would make it better. `verbose`: what was
    decided on the way, too."""
    audit, rounds, files = result.audit, result.state.rounds, settings.files
    frame = "" if files.number is None else f"frame {files.number}, "
    features = ", ".join(audit.features)
    found = [
        f"{files.output}: {frame}{audit.width} x {audit.height}, {result.renderer}, "
        f"{result.samples:.3g} samples per pixel"
        + (f" in {len(rounds)} rounds" if len(rounds) > 1 else "")
        + (f"; features: {features}" if features else "; no features"),
        f"  relative MSE {error_text(result.noise)} before, {error_text(result.error)} estimated after, "
        f"{seconds_text(result.seconds)}; {result.why_ended or 'the budget is spent'}",
        f"  better: {advice(result, settings, polyrecon)}",
    ]
    if not verbose:
        return found
    return [*found, *round_lines(result), *(f"  {line}" for line in audit.lines())]


def round_lines(result):
    return [
        f"  round {entry.round}: {entry.samples:.3g} spp, {entry.seconds:.1f} s, relMSE {error_text(entry.error)}"
        for entry in result.state.rounds
    ]


def advice(result, settings, polyrecon):
    """The options of the driver that would lower the error. result: of a frame or a shot."""
    budget, factor = settings.budget, 2 ** (1 / CONVERGENCE_RATE)
    if budget.target and MAX_ROUNDS in result.why_ended and missed(result, budget):
        return f"{MAX_ROUNDS} {2 * settings.max_rounds}"
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
        words.append(f"{prior.advice(polyrecon)}, since the samples are few")
    return "; ".join(words)


def missed(result, budget):
    """What a frame or a shot missed of its budget; '' where nothing."""
    if budget.target and not result.error <= budget.target:
        return f"estimated relMSE {error_text(result.error)}, so --target {budget.target:g} was missed: " + (
            result.why_ended
        )
    if budget.seconds and result.seconds > (1 + LATE_SHARE) * budget.seconds:
        return f"took {seconds_text(result.seconds)}, so --budget-seconds {budget.seconds:g} was missed"
    return ""


def write(result, settings, polyrecon, pages):
    """Writes the report to each path of `pages`: a viewer with what each round knew, and figures. It holds its
    pictures and loads nothing. Where these cannot be made, a note says so."""
    template = template_of(TEMPLATE)
    with WorkFolder("report") as folder:
        try:
            page = _make_page(result, settings, polyrecon, template, _images(result, settings), folder)
        except DriverError as error:  # The frame is finished, so it does not fail for a page's pictures.
            result.audit.notes.append(f"the report has no pictures: {error}")
            page = _make_page(result, settings, polyrecon, template, [], folder)
    for path in pages:
        write_text(path, page)


def template_of(path):
    environment = jinja2.Environment(
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
        finalize=lambda value: printable(value) if isinstance(value, str) else value,
    )
    environment.filters["error_text"] = error_text
    return environment.from_string(path.read_text(encoding="utf-8"))


def _make_page(result, settings, polyrecon, template, images, folder):
    """The text of the page, which the program makes from a description (docs/reference/view.md)."""
    files = settings.files
    description = {
        "title": files.output.name + ("" if files.number is None else f", frame {files.number}"),
        "subtitle": f"{result.renderer}, {polyrecon.version()}, {result.audit.width} x {result.audit.height}",
        "frame_name": "round",
        "frames": [f"{entry.round}: {entry.samples:.3g} spp" for entry in result.state.rounds] + ["result"],
        "images": images,
        "report": template.render(result=result, settings=settings, curve=_curve(result), size=CURVE),
    }
    write_text(folder / "page.json", json.dumps(description))
    polyrecon.run("view", "--page", folder / "page.json", "-o", folder / "page.html")
    return (folder / "page.html").read_text(encoding="utf-8")


def _images(result, settings):
    """The images of the page, with a file for each: what was known after each round, and at the end."""
    passes, rounds = PassFolder(settings.files.passes), result.state.rounds
    in_rounds = [
        ("input", "noisy", 0, result.merged),
        ("result", "clean", 0, settings.files.output),
        ("estimated error", "error", 0, result.error_map),
        ("samples that followed", "samples", 1, None),
    ]
    images = []
    for name, file, later, at_the_end in in_rounds:
        files = [passes.in_round(entry.round + later, file) for entry in rounds] + [at_the_end]
        images.append({"name": name, "files": [str(path) if path and path.exists() else None for path in files]})
    return images


def seconds_text(seconds):
    return f"{seconds:.1f} s" if seconds < 120 else f"{seconds / 60:.1f} min"


def error_text(error):
    return "unknown" if error is None or not math.isfinite(error) else f"{error:.3g}"


def _curve(result):
    """The estimated error against seconds, both logarithmic, in pixels of the drawing: points, and the ticks of both
    axes. `frame` of a point is its place among the frames of the viewer."""
    found = [(entry.seconds, entry.error) for entry in result.state.rounds] + [(result.seconds, result.error)]
    points = [
        (frame, max(x, 1e-3), y) for frame, (x, y) in enumerate(found) if y is not None and math.isfinite(y) and y > 0
    ]
    if not points:
        return {"points": [], "across": [], "upwards": []}
    across = LogAxis([x for _, x, _ in points], CURVE["left"], CURVE["right"])
    upwards = LogAxis([y for _, _, y in points], CURVE["bottom"], CURVE["top"])
    return {
        "points": [
            {"x": across.at(x), "y": upwards.at(y), "label": f"{x:.3g} s, {y:.3g}", "frame": frame}
            for frame, x, y in points
        ],
        "across": across.ticks(),
        "upwards": upwards.ticks(),
    }


class LogAxis:
    """A logarithmic axis over some values, with room at both ends, from one pixel of the drawing to another."""

    def __init__(self, values, begin, end):
        room = max((max(values) / min(values)) ** 0.06, 1.1)
        self.low, self.high = math.log(min(values) / room), math.log(max(values) * room)
        self.begin, self.end = begin, end

    def at(self, value):
        part = (math.log(value) - self.low) / (self.high - self.low)
        return round(self.begin + (self.end - self.begin) * part, 1)

    def ticks(self):
        """1, 2 and 5 times the powers of ten, more on a short axis, even steps where these are fewer than three: where
        each is, and its text."""
        decades = (self.high - self.low) / math.log(10)
        digits = (1,) if decades > 4 else (1, 2, 5) if decades > 1 else (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8)
        powers = range(math.floor(self.low / math.log(10)), math.ceil(self.high / math.log(10)) + 1)
        values = [digit * 10.0**power for power in powers for digit in digits]
        values = [value for value in values if self.low <= math.log(value) <= self.high]
        if len(values) < 3:
            low, high = math.exp(self.low), math.exp(self.high)
            power = 10.0 ** math.floor(math.log10((high - low) / 5))
            step = next(power * digit for digit in (1, 2, 5, 10) if power * digit >= (high - low) / 5)
            values = [k * step for k in range(math.ceil(low / step), math.floor(high / step) + 1)]
        return [{"at": self.at(value), "text": f"{value:g}"} for value in values]
