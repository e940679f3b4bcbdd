"""The page and the lines that tell what a loop did."""

import base64
import math
import os
import pathlib
import tempfile

import jinja2

from ..common.errors import DriverError, ExitCode

TEMPLATE = pathlib.Path(__file__).with_name("report.html.j2")
CURVE = {"width": 640, "height": 240, "margin": 48}


def text(result, settings, page):
    """A few lines for the terminal."""
    lines = [
        f"{settings.output}: {result.samples:.3g} samples per pixel, {result.seconds:.1f} s, estimated relMSE {result.error:.3g}"
    ]
    lines += [f"  budget {settings.budget}: {result.why_ended}"]
    lines += [
        f"  round {r['round']}: {r['spp']:.3g} spp, {r['seconds']:.1f} s, relMSE {r['error']:.3g}"
        for r in result.journal["rounds"]
    ]
    lines += [
        f"  {switch.effect} {switch.setting}: {switch.reason}" + (f" (saves {switch.saves})" if switch.saves else "")
        for switch in result.audit.switches
    ]
    lines += [f"  extra samples: {result.audit.method}"] + [f"  {note}" for note in result.audit.notes]
    return "\n".join([*lines, f"  report: {page}"])


def write(result, settings, polyrecon):
    """Writes report.html into the folder of passes; returns its path. One page, pictures inside, nothing loaded."""
    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    with tempfile.TemporaryDirectory() as folder:
        entries = result.journal["rounds"]
        files = [_files_of(entry["round"], settings.passes) for entry in entries] + [
            [result.merged, settings.output, result.error_map]
        ]
        *pictures, final = _pictures(polyrecon, files, pathlib.Path(folder))
    rounds = [{**entry, "picture": picture} for entry, picture in zip(entries, pictures)]
    page = environment.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        result=result, settings=settings, rounds=rounds, final=final, curve=_curve(result), size=CURVE
    )
    path = settings.passes / "report.html"
    temporary = path.with_suffix(".new")
    try:
        temporary.write_text(page, encoding="utf-8")
        os.replace(temporary, path)
    except OSError as error:
        raise DriverError(ExitCode.OUTPUT, f"{path}: {error.strerror}") from error
    return path


def _files_of(number, passes):
    """What a round knew, and the samples that followed."""
    place, following = passes / f"round_{number}", passes / f"round_{number + 1}" / "samples.exr"
    return [place / "noisy.exr", place / "clean.exr", place / "error.exr", *([following] if following.exists() else [])]


def _pictures(polyrecon, several, folder):
    """A PNG in base64 of each list of files; as many at a time as there are processors."""
    targets = [folder / f"{number}.png" for number in range(len(several))]
    words = [[*files, "-o", target] for files, target in zip(several, targets)]
    for begin in range(0, len(words), step := os.cpu_count() or 1):
        polyrecon.run_side_by_side("preview", words[begin : begin + step])
    return [base64.b64encode(target.read_bytes()).decode() for target in targets]


def _curve(result):
    """Points of the estimated error against seconds, both logarithmic, in pixels of the drawing: [{x, y, label}]."""

    points = [(entry["seconds"], entry["error"]) for entry in result.journal["rounds"]] + [
        (result.seconds, result.error)
    ]
    points = [(math.log(max(x, 1e-3)), math.log(y), x, y) for x, y in points if math.isfinite(y) and y > 0]

    def scaled(value, values, length):
        low, high = min(values), max(values)
        return CURVE["margin"] + (value - low) / ((high - low) or 1) * (length - 2 * CURVE["margin"])

    return [
        {
            "x": round(scaled(p[0], [q[0] for q in points], CURVE["width"]), 1),
            "y": round(CURVE["height"] - scaled(p[1], [q[1] for q in points], CURVE["height"]), 1),
            "label": f"{p[2]:.3g} s, {p[3]:.3g}",
        }
        for p in points
    ]
