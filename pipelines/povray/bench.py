#!/usr/bin/env python3
"""Makes the figures and pictures of docs/povray.md: for each scene a reference of 1024 subpixels a pixel, render_passes.py
and `polyrecon denoise`, adaptive.py, plain supersampling; relMSE and seconds of each. What is there already in --work is
not made again."""

if not __package__:  # run as a script from a checkout
    import pathlib
    import sys

    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    __package__ = "pipelines.povray"

import argparse
import json
import pathlib
import subprocess
import sys
import time

import numpy as np

from ..loop import exr
from ..loop.errors import run_main
from ..loop.polyrecon_cli import Polyrecon
from .scene import Crop, Scene
from .subpixels import estimate

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = pathlib.Path("/usr/share/doc/povray/examples")  # Debian: povray-examples
SCENES = {
    "still_life": (HERE.parents[1] / "samples/scenes/still_life.pov", 160, 90),
    "arealit2": (EXAMPLES / "lights/arealit2.pov", 128, 96),
    "woodbox": (EXAMPLES / "advanced/woodbox.pov", 128, 96),
    "pawns": (EXAMPLES / "advanced/pawns.pov", 128, 96),
    "focalblur": (EXAMPLES / "camera/focalblur.pov", 96, 72),
}
REFERENCE_GRID = 32
BAND = 24  # rows of the reference that are rendered at once


def main(words=None):
    return run_main("bench.py", _main, words)


def _main(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", choices=[[], *SCENES], help=f"{', '.join(SCENES)} (all)")
    parser.add_argument("--work", type=pathlib.Path, default=HERE.parents[1] / "out" / "povray")
    parser.add_argument("--only-references", action="store_true")
    options = parser.parse_args(words)
    options.work.mkdir(parents=True, exist_ok=True)
    for name in options.scenes or SCENES:
        reference(options.work, name)


def reference(work, name):
    """NAME_ref.exr: Combined, and the variance of its mean; also the errors that smaller grids have."""
    target = work / f"{name}_ref.exr"
    if target.exists():
        return target
    path, width, height = SCENES[name]
    with Scene(path, [f"+W{width}", f"+H{height}"]) as scene:
        bands = [
            estimate(scene.render(REFERENCE_GRID, crop=Crop(0, y, width, min(y + BAND, height))), REFERENCE_GRID)
            for y in range(0, height, BAND)
        ]
    channels = {}
    for kind in ("mean", "variance"):
        planes = np.concatenate([getattr(band, kind) for band in bands])
        channels.update({f"Combined{' Variance' * (kind == 'variance')}.{c}": planes[..., i] for i, c in enumerate("RGB")})
    exr.write(target, channels)
    return target


if __name__ == "__main__":
    sys.exit(main())
