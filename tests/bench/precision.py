#!/usr/bin/env python3
"""Compares the build for float with one for double on the samples.

Prints a Markdown table of the differences, which rounding causes:

    cmake --preset release -B build/double -DPOLYRECON_REAL=double && cmake --build build/double --target polyrecon
    tests/bench/precision.py build/release/src/polyrecon build/double/src/polyrecon
"""

import argparse
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = ["study_16", "glass_16", "lighthouse_16", "study_denoised_16", *(f"study_small_{k}" for k in range(4))]


def read(file, channel):
    image = oiio.ImageBuf(str(file))
    picked = oiio.ImageBufAlgo.channels(image, tuple(f"{channel}.{c}" for c in "RGB"))
    if image.has_error or picked.has_error:
        raise SystemExit(f"{file}: {image.geterror()} {picked.geterror()}")
    return picked.get_pixels(oiio.FLOAT).astype(float)


def run(program, file, folder, steps):
    """The result and its error map, in files of their own: OpenImageIO remembers what it has read."""
    folder = pathlib.Path(tempfile.mkdtemp(dir=folder))
    clean, error = folder / "clean.exr", folder / "error.exr"
    subprocess.run(
        [program, "denoise", "-i", file, "-o", clean, "--error-map", error, "--overwrite", "-q", "--steps", steps],
        check=True,
    )
    return read(clean, "ViewLayer.Combined"), read(error, "mse")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs=2, metavar="POLYRECON", help="the float build and the double build")
    parser.add_argument("--samples", nargs="+", default=SAMPLES)
    parser.add_argument("--pixels", type=int, default=0, metavar="N", help="also print the N pixels that differ most")
    parser.add_argument("--steps", default="auto", help="of denoise")
    args = parser.parse_args()
    print("| sample | largest | root mean square | over 1e-3 | over 1e-4 | sum of the error map |")
    print("|---|---|---|---|---|---|")
    for sample in args.samples:
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            # A result has the type of its input: float here, as rounding to half alone differs by up to 5e-4.
            subprocess.run(
                ["oiiotool", "-a", ROOT / f"samples/{sample}.exr", "-d", "float", "-o", folder / "in.exr"], check=True
            )
            (a, ea), (b, eb) = (run(p, folder / "in.exr", folder, args.steps) for p in args.programs)
        difference = (np.abs(a - b) / np.maximum(np.abs(b), b.mean())).max(axis=2)
        over = [f"{100 * (difference > limit).mean():.2g} %" for limit in (1e-3, 1e-4)]
        print(
            f"| {sample} | {difference.max():.2g} | {np.sqrt((difference**2).mean()):.2g} | {over[0]} | {over[1]} "
            f"| {abs(ea.sum() / eb.sum() - 1):.1g} |",
            flush=True,
        )
        for i in np.argsort(difference, axis=None)[::-1][: args.pixels]:
            y, x = np.unravel_index(i, difference.shape)
            print(f"  ({x}, {y}): {a[y, x]} {b[y, x]}")


if __name__ == "__main__":
    main()
