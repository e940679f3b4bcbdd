#!/usr/bin/env python3
"""Measures how the error falls with the samples: renders scenes at 4 to 1024 samples per pixel, denoises each step and
prints the errors of input and result (relMSE, relMSE without the 0.1 % worst pixels, FLIP) as Markdown tables.

A step is 4 or 8 pieces of one sample sequence, merged. The pictures are the middle half of the samples' (160 x 90
pixels), so that the shipped references fit. This needs a Python with bpy 5.0.1, numpy, OpenImageIO and flip-evaluator
(pip), oiiotool, and a build of polyrecon. It takes a quarter of an hour on two idle cores, nearly all of it for
renders. Renders that are in the work folder already are used again."""

import argparse
import json
import math
import subprocess
import sys

import flip_evaluator
import numpy as np
import OpenImageIO as oiio
from make_samples import HERE, Tools, run

STEPS = (4, 16, 64, 256, 1024)


def rgb(path, layer):
    """A colour layer of a single-part file as float32 (height, width, 3)."""
    pixels = oiio.ImageBuf(str(path))
    names = pixels.spec().channelnames
    return pixels.get_pixels("float")[..., [names.index(f"{layer}.{c}") for c in "RGB"]]


def reference_of(tools, scene):
    target = tools.work / f"{scene}_middle_ref.exr"
    run(["oiiotool", str(HERE / f"{scene}_ref.exr"), "--cut", "160x90+80+45", "-o", str(target)])
    return target


def relative_mse(tools, images, reference):
    """(relMSE, trimmed relMSE) of each image."""
    command = [tools.polyrecon, "compare", *map(str, images), str(reference), "--json"]
    printed = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return [(row["relMSE"], row["trimmed"]) for row in printed["results"] if row["layer"] == "ViewLayer.Combined"]


def flip(image, reference):
    layers = (np.ascontiguousarray(rgb(path, "ViewLayer.Combined")) for path in (reference, image))
    return float(flip_evaluator.evaluate(*layers, "HDR")[1])


def step(tools, scene, samples, reference, options):
    """(relMSE, trimmed, FLIP) of the input and of the result."""
    parts = min(8, samples)
    pieces = tools.render(
        5, scene, f"ladder_{scene}_{samples}", parts, spp=samples, middle=True, passes="denoising", single_part=True
    )
    noisy = tools.merge(pieces, f"ladder_{scene}_{samples}.exr", samples)
    clean = tools.work / f"ladder_{scene}_{samples}_clean.exr"
    run([tools.polyrecon, "denoise", "-i", str(noisy), "-o", str(clean), "--overwrite", "--quiet", *options])
    return [
        (*error, flip(file, reference))
        for file, error in zip((noisy, clean), relative_mse(tools, (noisy, clean), reference))
    ]


def rate(before, after):
    """Exponent a of error ~ samples^-a between two steps, which are a factor of 4 apart."""
    return math.log(before / after, 4) if before > 0 and after > 0 else float("nan")


def ladder(tools, scene, options):
    reference = reference_of(tools, scene)
    kinds = ("input", "result", "rate of the input", "rate of the result", "result / input")
    head = [scene, *[f"relMSE: {kind}" for kind in kinds], "trimmed: input", "result", "FLIP: input", "result"]
    print("\n| " + " | ".join(head) + " |\n|---" + "|---:" * (len(head) - 1) + "|", flush=True)
    last = None
    for samples in STEPS:
        noisy, clean = step(tools, scene, samples, reference, options)
        rates = [f"{rate(last[k][0], found[0]):.2f}" if last else "" for k, found in enumerate((noisy, clean))]
        cells = [f"{noisy[0]:.5f}", f"{clean[0]:.5f}", *rates, f"{clean[0] / noisy[0]:.3f}"]
        cells += [f"{noisy[1]:.5f}", f"{clean[1]:.5f}", f"{noisy[2]:.4f}", f"{clean[2]:.4f}"]
        print(f"| {samples} spp | " + " | ".join(cells) + " |", flush=True)
        last = noisy, clean


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="*", default=["study", "lighthouse"], help="study, lighthouse (both)")
    parser.add_argument("--work", default=str(HERE.parent / "out" / "ladder"), help="folder for renders and results")
    parser.add_argument("--blender5", default=sys.executable, help="Python with bpy 5.0.1")
    parser.add_argument("--polyrecon", default=str(HERE.parent / "build" / "release" / "src" / "polyrecon"))
    parser.add_argument("--quality", default="standard")
    options = parser.parse_args()
    options.blender3 = None
    tools = Tools(options)
    for scene in options.scene:
        ladder(tools, scene, ["--quality", options.quality])


if __name__ == "__main__":
    main()
