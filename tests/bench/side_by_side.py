#!/usr/bin/env python3
"""Draws crops of the samples at 300 %, one row each: noisy, Open Image Denoise alone (accurate prefilter, high
quality), polyrecon with default settings, polyrecon with `--prior oidn`, reference. Errors stand below the pictures.
Writes docs/results/samples.jpg. Needs a Python with pyoidn, numpy and OpenImageIO; build the release preset first.

    tests/bench/side_by_side.py --oidn build/venv/lib/python3.11/site-packages/pyoidn/oidn/lib/libOpenImageDenoise.so.2
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from second_opinion import network  # noqa: E402

from pipelines.common import exr  # noqa: E402

REGIONS = {"study": "150,40,110,80", "glass": "90,90,110,80", "lighthouse": "90,70,110,80"}  # x, y, width, height
ZOOM = "3"


def draw(program, sample, folder):
    """The row of a sample, as a picture in folder."""
    folder.mkdir()
    shutil.copy(ROOT / "samples" / f"{sample}_16.exr", folder / "noisy.exr")
    shutil.copy(ROOT / "samples" / f"{sample}_ref.exr", folder / "reference.exr")
    (picture,) = network(exr.read(str(folder / "noisy.exr")), "Combined")
    exr.write(folder / "oidn.exr", {f"ViewLayer.Combined.{c}": picture[..., k] for k, c in enumerate("RGB")})
    for name, options in (("polyrecon", []), ("polyrecon with oidn", ["--prior", "oidn"])):
        target = folder / f"{name}.exr"
        subprocess.run([program, "denoise", "-i", folder / "noisy.exr", "-o", target, "-q", *options], check=True)
    files = [folder / f"{n}.exr" for n in ("noisy", "oidn", "polyrecon", "polyrecon with oidn", "reference")]
    crop = ["--region", REGIONS[sample], "--zoom", ZOOM, "--reference", files[-1]]
    subprocess.run([program, "preview", *files, "-o", folder / "row.png", *crop], check=True)
    return folder / "row.png"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--oidn", default=os.environ.get("POLYRECON_OIDN"), help="libOpenImageDenoise.so.2")
    parser.add_argument("--polyrecon", default=ROOT / "build" / "release" / "src" / "polyrecon")
    options = parser.parse_args()
    if options.oidn:
        os.environ["POLYRECON_OIDN"] = options.oidn
    with tempfile.TemporaryDirectory() as folder:
        rows = [draw(options.polyrecon, sample, pathlib.Path(folder) / sample) for sample in REGIONS]
        target = ROOT / "docs" / "results" / "samples.jpg"
        mosaic = ["--mosaic", f"1x{len(rows)}", "--ch", "R,G,B", "--compression", "jpeg:90"]
        subprocess.run(["oiiotool", *rows, *mosaic, "-o", target], check=True)


if __name__ == "__main__":
    main()
