#!/usr/bin/env python3
"""Compares the true squared error with the estimated one by decile of the estimate, on the samples or on other
renders (IN.exr=REFERENCE.exr ...). For the samples it writes docs/results/error_map.png and the table of
docs/results/reliability.md; for others it prints the table. Needs matplotlib. Under a minute."""

import argparse
import pathlib
import subprocess
import tempfile

import matplotlib
import numpy as np
import OpenImageIO as oiio
from accuracy import ROOT, SAMPLES, table, write_between
from relmse import relative_squares

matplotlib.use("Agg")
import matplotlib.pyplot as plt

DECILES = 10


def read(path, *suffixes):
    """The channels whose names end so, of the first part that has them all; None where there is none."""
    for part in range(32):
        image = oiio.ImageBuf(str(path), part, 0)
        if image.has_error or not image.initialized:
            return None
        names = image.spec().channelnames
        found = [next((i for i, n in enumerate(names) if n == s or n.endswith("." + s)), None) for s in suffixes]
        if None not in found:
            return image.get_pixels(oiio.FLOAT)[..., found].astype(float)
    return None


def errors(program, render, reference):
    """(estimated, true) relative squared error of every pixel by default settings."""
    with tempfile.TemporaryDirectory() as folder:
        out, maps = pathlib.Path(folder, "out.exr"), pathlib.Path(folder, "map.exr")
        subprocess.run([program, "denoise", "-i", render, "-o", out, "--error-map", maps, "--quiet"], check=True)
        result, estimated = read(out, "Combined.R", "Combined.G", "Combined.B"), read(maps, "relmse.Y")[..., 0]
    truth = read(reference, "Combined.R", "Combined.G", "Combined.B")
    noise = read(reference, *(f"Combined Variance.{c}" for c in "RGB"))
    true = relative_squares(result, truth, 0 if noise is None else np.nan_to_num(noise))
    return estimated.ravel(), true.mean(-1).ravel()


def deciles(estimated, true):
    """(mean estimated, mean true) of each tenth of the pixels, by growing estimate."""
    parts = np.array_split(np.argsort(estimated, kind="stable"), DECILES)
    return np.array([(estimated[p].mean(), true[p].mean()) for p in parts])


def row(name, estimated, true):
    ratios = [f"{t / e:.2f}" if e > 0 else "-" for e, t in deciles(estimated, true)]
    return [name, f"{true.mean():.5f}", f"{estimated.mean() / true.mean():.2f}", *ratios]


def markdown(rows):
    return table(["render", "true relMSE", "estimated / true"] + [f"{d}" for d in range(1, DECILES + 1)], rows)


def plot(found, path):
    figure, axes = plt.subplots(1, len(found), figsize=(3.4 * len(found), 3.4), layout="constrained")
    for axis, (name, (estimated, true)) in zip(axes, found.items()):
        points = deciles(estimated, true)
        points = points[(points > 0).all(axis=1)]
        ends = np.array([points.min() / 2, points.max() * 2])
        axis.fill_between(ends, ends / 1.5, ends * 1.5, color="0.9", label="within 1.5")
        axis.plot(ends, ends, color="0.6", linewidth=1)
        axis.plot(points[:, 0], points[:, 1], "o-", markersize=4)
        axis.set(xscale="log", yscale="log", xlim=ends, ylim=ends, title=name, xlabel="estimated", aspect="equal")
    axes[0].set_ylabel("true")
    axes[0].legend(frameon=False, loc="upper left")
    figure.savefig(path, dpi=80, bbox_inches="tight")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pairs", nargs="*", metavar="IN.exr=REFERENCE.exr", help="instead of the samples")
    parser.add_argument("--polyrecon", default=ROOT / "build/release/src/polyrecon", metavar="PATH")
    options = parser.parse_args()
    if options.pairs:
        pairs = [pair.split("=") for pair in options.pairs]
        print(markdown([row(pathlib.Path(i).name, *errors(options.polyrecon, i, r)) for i, r in pairs]))
        return
    found = {}
    for name, reference in SAMPLES.items():
        files = ROOT / "samples" / f"{name}_16.exr", ROOT / "samples" / f"{reference}_ref.exr"
        found[name] = errors(options.polyrecon, *files)
    text = markdown([row(name, *f) for name, f in found.items()])
    write_between(ROOT / "docs/results/reliability.md", "reliability", text, "reliability.py")
    plot(found, ROOT / "docs/results/error_map.png")


if __name__ == "__main__":
    main()
