#!/usr/bin/env python3
"""Compares Open Image Denoise alone (accurate prefilter, high quality, on the mean) with `denoise` alone and with
`denoise --prior oidn`, on renders of which references are known. Needs a Python with pyoidn and OpenImageIO.

    tests/bench/second_opinion.py samples/study_16.exr=samples/study_ref.exr ...

relMSE is that of relmse.py; "trimmed" leaves out the 0.1 % of worst pixels; figures of
the program are over those of the network alone. "energy" is the change of the picture's sum, in percent of the
render's."""

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
from relmse import relative_squares  # noqa: E402

from pipelines.common import exr  # noqa: E402


def layer(channels, name, components="RGB", required=True):
    for head in (f"ViewLayer.{name}", name):
        if f"{head}.{components[0]}" in channels:
            return numpy.stack([channels[f"{head}.{c}"] for c in components], -1).astype("f")
    if required:
        raise SystemExit(f"no layer {name}")
    return None


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


def network_alone(channels):
    albedo = prefiltered(layer(channels, "Denoising Albedo"), "albedo")
    normal = prefiltered(layer(channels, "Denoising Normal", "XYZ"), "normal")
    return pyoidn.denoise(layer(channels, "Combined"), albedo, normal, hdr=True, clean_aux=True, quality="high")


def scores(picture, reference, variance):
    error = relative_squares(picture.astype("d"), reference.astype("d"), variance).mean(-1)
    return error.mean(), numpy.sort(error.ravel())[: int(error.size * 0.999)].mean()


def denoised(program, render, quality, more, folder):
    begin = time.perf_counter()
    out = folder / "out.exr"
    subprocess.run(
        [program, "denoise", "-i", render, "-o", out, "--overwrite", "--quality", quality, "-q", *more], check=True
    )
    seconds = time.perf_counter() - begin
    return layer(exr.read(str(out)), "Combined"), seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="+", metavar="RENDER=REFERENCE")
    parser.add_argument("--quality", default="standard")
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/src/polyrecon")
    options = parser.parse_args()
    print("| render | network, relMSE | ours | both | both, trimmed | both, energy | seconds: network | ours | both |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    ratios = []
    for case in options.cases:
        render, reference = case.split("=")
        channels, known = exr.read(render), exr.read(reference)
        truth, variance = layer(known, "Combined"), layer(known, "Combined Variance", required=False)
        variance = 0 if variance is None else variance
        begin = time.perf_counter()
        alone, alone_trimmed = scores(network_alone(channels), truth, variance)
        seconds = [time.perf_counter() - begin]
        found = []
        with tempfile.TemporaryDirectory() as folder:
            for more in ([], ["--prior", "oidn"]):
                picture, spent = denoised(options.program, render, options.quality, more, pathlib.Path(folder))
                found.append((*scores(picture, truth, variance), picture.mean() / layer(channels, "Combined").mean()))
                seconds.append(spent)
        (ours, _, _), (both, both_trimmed, energy) = found
        ratios.append((ours / alone, both / alone, both_trimmed / alone_trimmed))
        print(
            f"| {pathlib.Path(render).stem} | {alone:.5f} | {ratios[-1][0]:.3f} | {ratios[-1][1]:.3f} | "
            f"{ratios[-1][2]:.3f} | {100 * (energy - 1):+.2f} | " + " | ".join(f"{s:.1f}" for s in seconds) + " |",
            flush=True,
        )
    means = [math.exp(sum(map(math.log, column)) / len(column)) for column in zip(*ratios)]
    print("| geometric mean | | " + " | ".join(f"{mean:.3f}" for mean in means) + " | | | | |")


if __name__ == "__main__":
    main()
