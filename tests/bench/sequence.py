#!/usr/bin/env python3
"""How much frames before and after help: denoises the animation of samples/make_sequence.py with several --frame-radius
and prints relMSE of each frame and flicker, in thousandths, and the frame that loses most against the first radius.
Needs numpy and OpenImageIO's Python module.

relMSE: as relmse.py computes it; r is the reference, and Var r the variance of its mean.
flicker: variance over the frames of a shot of the relative error (x - r) / sqrt(r^2 + relmse.FLOOR), less the variance
that the reference's noise adds, averaged over pixels and shots.
"""

import argparse
import pathlib
import subprocess

import numpy
import OpenImageIO
from relmse import denominator

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHOTS = (range(1, 7), range(7, 11))


def layer(path, name):
    image = OpenImageIO.ImageBuf(str(path))
    channels = list(image.spec().channelnames)
    pixels = image.get_pixels(OpenImageIO.FLOAT)
    return numpy.stack([pixels[..., channels.index(f"ViewLayer.{name}.{c}")] for c in "RGB"], -1).astype(float)


def measure(folder, results):
    """relMSE of each frame, flicker."""
    errors, noises = {}, {}
    for frame in (frame for shot in SHOTS for frame in shot):
        reference = layer(folder / f"ref.{frame:04d}.exr", "Combined")
        scale = denominator(reference)
        noises[frame] = layer(folder / f"ref.{frame:04d}.exr", "Combined Variance") / scale
        errors[frame] = (layer(results(frame), "Combined") - reference) / numpy.sqrt(scale)
    relmse = {frame: (errors[frame] ** 2 - noises[frame]).mean() for frame in errors}
    flicker = 0
    for shot in SHOTS:
        of_errors = numpy.stack([errors[frame] for frame in shot]).var(axis=0, ddof=1).mean()
        flicker += (of_errors - numpy.mean([noises[frame].mean() for frame in shot])) / len(SHOTS)
    return relmse, flicker


def denoise(options, spp, radius):
    target = options.work / "bench" / f"{spp}_radius{radius}"
    target.mkdir(parents=True, exist_ok=True)
    command = [
        options.polyrecon,
        "denoise",
        "-i",
        options.work / f"parade_{spp}.####.exr",
        "-o",
        target / "####.exr",
        "--overwrite",
    ]
    subprocess.run(list(map(str, [*command, "--quiet", "--frame-radius", radius, *options.words])), check=True)
    return lambda frame: target / f"{frame:04d}.exr"


def noisy(options, spp):
    return lambda frame: options.work / f"parade_{spp}.{frame:04d}.exr"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--work", type=pathlib.Path, default=ROOT / "out" / "sequence", help="what make_sequence.py made"
    )
    parser.add_argument("--polyrecon", default=str(ROOT / "build" / "release" / "src" / "polyrecon"))
    parser.add_argument("--spp", type=int, nargs="*", default=[8, 64, 128])
    parser.add_argument("--radius", type=int, nargs="*", default=[0, 1, 2, 3])
    parser.add_argument("words", nargs="*", help="further options of polyrecon denoise, after --")
    options = parser.parse_args()
    options.work = options.work.resolve()
    for spp in options.spp:
        rows = [("input", *measure(options.work, noisy(options, spp)))]
        for radius in options.radius:
            rows.append((f"radius {radius}", *measure(options.work, denoise(options, spp, radius))))
        print_table(spp, rows)


def print_table(spp, rows):
    print(
        f"\n| {spp} samples | " + " | ".join(str(frame) for frame in rows[0][1]) + " | mean | flicker | worst frame |"
    )
    print("|---" * (len(rows[0][1]) + 4) + "|")
    base = rows[1][1]  # of the first radius
    for name, relmse, flicker in rows:
        cells = [f"{1e3 * value:.3f}" for value in (*relmse.values(), numpy.mean(list(relmse.values())), flicker)]
        worst = max(relmse[frame] / base[frame] for frame in base)
        print(f"| {name} | " + " | ".join(cells) + f" | {worst:.2f} x |", flush=True)


if __name__ == "__main__":
    main()
