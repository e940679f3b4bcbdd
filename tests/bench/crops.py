#!/usr/bin/env python3
"""Draws crops of the samples at 300 %, one row each: noisy, result of an older program, result of today's, reference.
Writes docs/results/crops.png and the list of its rows in docs/results/pictures.md. Needs numpy and OpenImageIO's Python
module.

    tests/bench/crops.py --before /path/to/older/polyrecon
"""

import argparse
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio
from accuracy import ROOT, table, write_between
from false_edges import display_values
from pictures import colours

SCALE = 3
GAP = 4  # pixels between crops
WIDTH, HEIGHT = 80, 50  # of a crop
CROPS = (  # sample, left, top, what the crop shows
    ("glass", 50, 95, "the white caustic: its rim, and dots around it"),
    ("glass", 0, 105, "the green ball: mottle"),
    ("glass", 90, 130, "the gold ring: dots in its hole and on the table"),
    ("glass", 170, 25, "the copper ball: the mirror image of the ring"),
    ("glass", 190, 110, "the amber caustic"),
    ("study", 190, 55, "the lamp: its shade; the walls: texture and mottle"),
    ("study", 0, 30, "the window: its bars"),
    ("lighthouse", 100, 100, "the sea: grain"),
)
LAYER = "ViewLayer.Combined"  # of the samples


def denoise(program, render, folder, name):
    target = folder / f"{name}.exr"
    subprocess.run([program, "denoise", "-i", render, "-o", target, "--overwrite", "-q"], check=True)
    return target


def pictures_of(sample, options, folder):
    """Noisy, before, after and reference in display values."""
    render = ROOT / "samples" / f"{sample}_16.exr"
    paths = [render]
    paths += [denoise(p, render, folder, f"{sample}_{k}") for k, p in enumerate((options.before, options.polyrecon))]
    paths.append(ROOT / "samples" / f"{sample}_ref.exr")
    return [display_values(colours(path, LAYER)) for path in paths]


def enlarged(picture, left, top):
    return picture[top : top + HEIGHT, left : left + WIDTH].repeat(SCALE, 0).repeat(SCALE, 1)


def sheet(rows):
    """The crops of all rows with white gaps, (height, width, 3)."""
    width, height = SCALE * WIDTH + GAP, SCALE * HEIGHT + GAP
    out = np.ones((len(rows) * height - GAP, len(rows[0]) * width - GAP, 3))
    for y, row in enumerate(rows):
        for x, crop in enumerate(row):
            out[y * height : y * height + crop.shape[0], x * width : x * width + crop.shape[1]] = crop
    return out


def write_png(path, picture):
    spec = oiio.ImageSpec(picture.shape[1], picture.shape[0], 3, "uint8")
    file = oiio.ImageOutput.create(str(path))
    if not file or not file.open(str(path), spec) or not file.write_image(picture.astype(np.float32)):
        raise SystemExit(f"{path}: {file.geterror() if file else oiio.geterror()}")
    file.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", required=True, help="an older build of polyrecon")
    parser.add_argument("--polyrecon", default=ROOT / "build" / "release" / "src" / "polyrecon")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        samples = {s: pictures_of(s, options, pathlib.Path(folder)) for s in dict.fromkeys(c[0] for c in CROPS)}
    rows = [[enlarged(picture, left, top) for picture in samples[sample]] for sample, left, top, _ in CROPS]
    results = ROOT / "docs" / "results"
    write_png(results / "crops.png", sheet(rows))
    lines = [[str(k), sample, what] for k, (sample, _, _, what) in enumerate(CROPS, 1)]
    write_between(results / "pictures.md", "crops", table(["row", "sample", "what it shows"], lines), "crops.py")


if __name__ == "__main__":
    main()
