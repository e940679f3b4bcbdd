#!/usr/bin/env python3
"""Compares Open Image Denoise alone (accurate prefilter, high quality, on the mean) with `denoise` alone and with
`denoise --prior oidn`, on renders of which references are known. Needs a Python with pyoidn and OpenImageIO.

    tests/bench/second_opinion.py samples/study_16.exr=samples/study_ref.exr ...
    tests/bench/second_opinion.py --broken samples/study_16.exr=samples/study_ref.exr ...

Figures are those of `polyrecon compare`, and false edges those of tests/bench/false_edges.py. "energy" is the change of
the picture's sum, in percent of the render's.

--broken: priors with halves that are wrong, as layers of the render; relMSE of the result over that without a prior.
Renders without halves are refused then."""

import argparse
import math
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy
import pyoidn
from pyoidn.filter import OIDN_FORMAT_FLOAT3, OIDN_QUALITY_HIGH

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from accuracy import mean, table  # noqa: E402
from pictures import figures  # noqa: E402

from pipelines.common import exr  # noqa: E402

SHIFT = 3  # pixels
BLUR = 8  # pixels, the standard deviation
HOLES = 32  # pixels, the side of squares that are not finite, one in each square of twice that side


def layer(channels, name, components="RGB"):
    for head in (f"ViewLayer.{name}", name):
        if f"{head}.{components[0]}" in channels:
            return numpy.stack([channels[f"{head}.{c}"] for c in components], -1).astype("f")
    raise SystemExit(f"no layer {name}")


def channels_of(name, picture):
    return {f"{name}.{c}": picture[..., i] for i, c in enumerate("RGB")}


def prefiltered(image, name):
    device = pyoidn.Device()
    device.commit()
    out, image = numpy.zeros_like(image), numpy.ascontiguousarray(image)
    with pyoidn.Filter(device, "RT") as one:
        one.set_image(name, image, OIDN_FORMAT_FLOAT3)
        one.set_image("output", out, OIDN_FORMAT_FLOAT3)
        one.set_quality(OIDN_QUALITY_HIGH)
        one.commit()
        one.execute()
    return out


def network(channels, *layers):
    """The network's pictures of layers of a render."""
    albedo = prefiltered(layer(channels, "Denoising Albedo"), "albedo")
    normal = prefiltered(layer(channels, "Denoising Normal", "XYZ"), "normal")
    return [
        pyoidn.denoise(layer(channels, name), albedo, normal, hdr=True, clean_aux=True, quality="high")
        for name in layers
    ]


def denoised(options, render, out, *more):
    """Denoises a render. Returns seconds."""
    begin = time.perf_counter()
    words = ["--overwrite", "--quality", options.quality, "--quiet", *more]
    command = [options.program, "denoise", "-i", render, "-o", out, *words]
    subprocess.run(command, check=True)
    return time.perf_counter() - begin


def blurred(image):
    """A Gaussian of BLUR pixels along rows and columns; the border is repeated."""
    weights = numpy.exp(-0.5 * (numpy.arange(-3 * BLUR, 3 * BLUR + 1) / BLUR) ** 2)
    for axis in (0, 1):
        padding = [(3 * BLUR, 3 * BLUR) if a == axis else (0, 0) for a in range(3)]
        padded = numpy.pad(image, padding, "edge")
        image = numpy.lib.stride_tricks.sliding_window_view(padded, len(weights), axis) @ (weights / weights.sum())
    return image.astype("f")


def with_holes(image):
    out = image.copy()
    for y in range(0, len(out), 2 * HOLES):
        for x in range(0, out.shape[1], 2 * HOLES):
            out[y : y + HOLES, x : x + HOLES] = numpy.nan
    return out


def broken_priors(channels):
    """{what is wrong: (half A, half B)}; the first one is right."""
    a, b, both = network(channels, "Combined A", "Combined B", "Combined")
    noisy = layer(channels, "Combined A"), layer(channels, "Combined B")
    return {
        "none": (a, b),
        "black": (0 * a, 0 * b),
        f"shifted by {SHIFT}": [numpy.roll(half, SHIFT, 1) for half in (a, b)],
        f"blurred by {BLUR}": [blurred(half) for half in (a, b)],
        "times 1.5": (1.5 * a, 1.5 * b),
        "of another frame": [half[::-1, ::-1] for half in (a, b)],
        "holes": [with_holes(half) for half in (a, b)],
        "the noise itself": noisy,
        "halves swapped": (b, a),
        "both of the mean": (both, both),
        "the noise, swapped": noisy[::-1],
    }


def broken_row(options, render, reference, folder):
    """{what is wrong: relMSE over that without a prior}"""
    channels = exr.read(render)
    pictures = {"without": folder / "without.exr"}
    denoised(options, render, pictures["without"])
    for number, (name, (a, b)) in enumerate(broken_priors(channels).items()):
        priors = channels_of("Prior", (a + b) / 2) | channels_of("Prior A", a) | channels_of("Prior B", b)
        exr.write(str(folder / "in.exr"), channels | priors)
        pictures[name] = folder / f"{number}.exr"
        denoised(options, folder / "in.exr", pictures[name], "--prior", "Prior")
    errors = {name: row[0] for name, row in figures(options.program, pictures, reference).items()}
    return {name: error / errors["without"] for name, error in errors.items() if name != "without"}


def broken(options):
    rows = {}
    for case in options.cases:
        render, reference = case.split("=")
        with tempfile.TemporaryDirectory() as folder:
            rows[pathlib.Path(render).stem] = broken_row(options, render, reference, pathlib.Path(folder))
    lines = []
    for name in next(iter(rows.values())):
        ratios = [row[name] for row in rows.values()]
        lines.append([name, *(f"{ratio:.3f}" for ratio in ratios), f"{mean(ratios):.3f}"])
    print(table(["what is wrong", *rows, "geometric mean"], lines))


def compared(options):
    head = ["render", "network, relMSE", "ours", "both", "both, trimmed", "both, FLIP"]
    head += ["false edges: network", "ours", "both", "both, energy", "seconds: network", "ours", "both"]
    lines, ratios = [], []
    for case in options.cases:
        render, reference = case.split("=")
        channels = exr.read(render)
        begin = time.perf_counter()
        alone = network(channels, "Combined")[0]
        seconds = [time.perf_counter() - begin]
        with tempfile.TemporaryDirectory() as folder:
            pictures = {name: pathlib.Path(folder) / f"{name}.exr" for name in ("network", "ours", "both")}
            exr.write(str(pictures["network"]), channels_of("Combined", alone))
            seconds.append(denoised(options, render, pictures["ours"]))
            seconds.append(denoised(options, render, pictures["both"], "--prior", "oidn"))
            found = figures(options.program, pictures, reference)
            sums = [layer(exr.read(str(pictures["both"])), "Combined").sum(), layer(channels, "Combined").sum()]
        net, ours, both = (found[name] for name in pictures)
        ratios.append([ours[0] / net[0], *(both[k] / net[k] for k in range(3))])
        line = [pathlib.Path(render).stem, f"{net[0]:.5f}", *(f"{ratio:.3f}" for ratio in ratios[-1])]
        line += [f"{row[4]:.1f}" for row in (net, ours, both)] + [f"{100 * (sums[0] / sums[1] - 1):+.3f}"]
        lines.append(line + [f"{s:.1f}" for s in seconds])
    means = [math.exp(sum(map(math.log, column)) / len(column)) for column in zip(*ratios)]
    lines.append(["geometric mean", "", *(f"{value:.3f}" for value in means), *7 * [""]])
    print(table(head, lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="+", metavar="RENDER=REFERENCE")
    parser.add_argument("--quality", default="standard")
    parser.add_argument("--broken", action="store_true", help="try priors that are wrong")
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/src/polyrecon")
    options = parser.parse_args()
    broken(options) if options.broken else compared(options)


if __name__ == "__main__":
    main()
