"""The report of a shot: a page, and a few lines for the terminal."""

import json
import math
import os
import pathlib
import urllib.parse

import numpy as np

from ..common import exr
from ..common.errors import DriverError
from ..common.files import write_text
from ..common.work_folder import WorkFolder
from .report import LogAxis, advice, error_text, round_lines, seconds_text, template_of

TEMPLATE = pathlib.Path(__file__).with_name("shot_report.html.j2")
PLOT = {"width": 1000, "height": 220, "left": 74, "right": 984, "top": 14, "bottom": 180}  # Pixels
SHEET_WIDTH = 320  # Largest width of a picture of the contact sheet, in pixels


def lines(result, verbose, polyrecon):
    """What is printed of a shot: its frames, and what would make it better. `verbose`: what was decided on the way,
    too."""
    (settings, first), frames = result.frames[0], [frame for _, frame in result.frames]
    few, many = (limit(frame.samples for frame in frames) for limit in (min, max))
    features = ", ".join(first.audit.features)
    found = [line for entry in result.frames for line in _lines_of_frame(*entry, verbose)]
    found += [
        f"shot: {len(frames)} frames, {first.audit.width} x {first.audit.height}, {first.renderer}, "
        f"{result.samples:.3g} samples per pixel on average, {few:.3g} to {many:.3g} in a frame; "
        + (f"features: {features}" if features else "no features"),
        f"  relative MSE {error_text(result.noise)} before, {error_text(result.error)} estimated after, "
        f"{seconds_text(result.seconds)}; {result.why_ended}",
        f"  better: {advice(result, settings, polyrecon)}",
    ]
    return [*found, *(f"  {line}" for line in first.audit.lines())] if verbose else found


def _lines_of_frame(settings, frame, verbose):
    rounds = len(frame.state.rounds)
    first = (
        f"{settings.files.output}: frame {settings.files.number}, {frame.samples:.3g} samples per pixel"
        + (f" in {rounds} rounds" if rounds > 1 else "")
        + f", relative MSE {error_text(frame.noise)} before, {error_text(frame.error)} estimated after"
    )
    return [first, *(round_lines(frame) if verbose else [])]


def write(result, polyrecon, page):
    """Writes the page of a shot: small pictures of all frames, plots, and a table with links to the frames' pages.
    Where the pictures cannot be made, a note says so."""
    with WorkFolder("report") as folder:
        try:
            text = _make_page(result, polyrecon, page, _images(result, folder), folder)
        except DriverError as error:  # The shot is finished, so it does not fail for a page's pictures.
            result.frames[0][1].audit.notes.append(f"the report of the shot has no pictures: {error}")
            text = _make_page(result, polyrecon, page, [], folder)
    write_text(page, text)


def _make_page(result, polyrecon, page, images, folder):
    """The text of the page, which the program makes from a description (docs/reference/view.md)."""
    first = result.frames[0][1]
    rows = [_row(settings, frame, page) for settings, frame in result.frames]
    plots = [
        _plot("estimated relMSE", rows, "error"),
        _plot("samples per pixel", rows, "samples"),
        _plot("seconds of rendering and decisions", rows, "seconds"),
    ]
    description = {
        "title": f"{page.stem}, {len(rows)} frames",
        "subtitle": f"{first.renderer}, {polyrecon.version()}, {first.audit.width} x {first.audit.height}",
        "frame_name": "frame",
        "frames": [f"{row['number']}: {row['samples']:.3g} spp" for row in rows],
        "images": images,
        "report": template_of(TEMPLATE).render(
            result=result, rows=rows, plots=plots, size=PLOT, has_pages=any(row["link"] for row in rows)
        ),
    }
    write_text(folder / "page.json", json.dumps(description))
    polyrecon.run("view", "--page", folder / "page.json", "-o", folder / "page.html")
    return (folder / "page.html").read_text(encoding="utf-8")


def _row(settings, frame, page):
    link = settings.files.report
    return {
        "number": settings.files.number,
        "link": urllib.parse.quote(os.path.relpath(link, page.parent)) if link else None,
        "samples": frame.samples,
        "rounds": len(frame.state.rounds),
        "noise": frame.noise,
        "error": frame.error,
        "seconds": frame.seconds,
    }


def _images(result, folder):
    """The images of the page: the picture and the estimated error of each frame, reduced."""
    images = []
    for name, source in (
        ("result", lambda settings, frame: _picture(settings.files.output, frame.audit.beauty)),
        ("estimated error", lambda settings, frame: {"relmse.Y": exr.read(frame.error_map)["relmse.Y"]}),
    ):
        files = []
        for settings, frame in result.frames:
            file = folder / f"{name[0]}_{settings.files.number}.exr"
            exr.write(file, {channel: _reduced(values) for channel, values in source(settings, frame).items()})
            files.append(str(file))
        images.append({"name": name, "files": files})
    return images


def _picture(path, beauty):
    prefix = f"{beauty}." if beauty else ""
    channels = exr.read(path, lambda name: name in {prefix + channel for channel in "RGB"})
    return {name.removeprefix(prefix): values for name, values in channels.items()}


def _reduced(values):
    """Means of square blocks of pixels, so that the width is SHEET_WIDTH at most. Rows and columns that fill no block
    are left out."""
    height, width = values.shape
    size = min(math.ceil(width / SHEET_WIDTH), height, width)
    rows, columns = height // size, width // size
    return values[: rows * size, : columns * size].reshape(rows, size, columns, size).mean((1, 3), dtype=np.float64)


def _plot(title, rows, key):
    """A value over the frames, in pixels of the drawing, its axis logarithmic. `frame` of a point is its place among
    the frames of the viewer."""
    known = [(place, row[key]) for place, row in enumerate(rows) if math.isfinite(row[key]) and row[key] > 0]
    if not known:
        return {"title": title, "points": [], "across": [], "upwards": []}
    upwards = LogAxis([value for _, value in known], PLOT["bottom"], PLOT["top"])
    step = (PLOT["right"] - PLOT["left"]) / len(rows)

    def across(place):
        return round(PLOT["left"] + (place + 0.5) * step, 1)

    every = math.ceil(len(rows) / 24)
    return {
        "title": title,
        "points": [
            {"x": across(place), "y": upwards.at(value), "label": f"frame {rows[place]['number']}: {value:.3g}"}
            | {"frame": place}
            for place, value in known
        ],
        "across": [
            {"at": across(place), "text": row["number"]} for place, row in enumerate(rows) if place % every == 0
        ],
        "upwards": upwards.ticks(),
    }
