#!/usr/bin/env python3
"""Makes the table of POV-Ray in docs/results/adaptive.md: for each scene a reference of 1024 subpixels a pixel,
render_passes.py and `polyrecon denoise`, adaptive.py; relMSE and processor seconds of each. A reference that is there
in --work is not made again. With --picture its picture instead."""

if not __package__:  # run as a script from a checkout
    import pathlib
    import sys

    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    __package__ = "pipelines.povray"

import argparse
import pathlib
import resource
import shutil
import subprocess
import sys

import numpy as np

from ..common import exr
from ..common.errors import run_main
from ..common.polyrecon_cli import Polyrecon
from . import gallery
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
GALLERY = [SCENES["still_life"][0]] + [
    EXAMPLES / "advanced" / name for name in ("woodbox.pov", "chess2.pov", "wineglass.pov", "glasschess/glasschess.pov")
]
REFERENCE_GRID = 32
UNIFORM_GRIDS = (4, 8)  # after the first pass of 2 x 2: 20 and 68 samples where there is noise
ADAPTIVE_SAMPLES = 68
BAND = 24  # rows of the reference that are rendered at once


def main(words=None):
    return run_main("bench.py", _main, words)


def _main(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{', '.join(SCENES)} (all)")
    parser.add_argument("--work", type=pathlib.Path, default=HERE.parents[1] / "out" / "povray")
    parser.add_argument("--only-references", action="store_true", help="leave it at the references")
    parser.add_argument("--picture", type=pathlib.Path, metavar="FILE.jpg", help="write scenes and their passes here")
    options = parser.parse_args(words)
    if unknown := set(options.scenes) - set(SCENES):
        parser.error(f"no such scene: {', '.join(sorted(unknown))}")
    if options.picture:
        gallery.write(options.picture, GALLERY)
        return
    options.work.mkdir(parents=True, exist_ok=True)
    for name in options.scenes or SCENES:
        reference(options.work, name)
        if not options.only_references:
            print(f"{name}", flush=True)
            for line in measure(options.work, name):
                print(line, flush=True)


def measure(work, name):
    """Lines of the table: what, samples per pixel, relMSE of the mean and of the reconstruction, processor seconds."""
    path, width, height = SCENES[name]
    size = ["--", f"+W{width}", f"+H{height}"]
    for grid in UNIFORM_GRIDS:
        merged, clean = work / f"{name}_{grid}.exr", work / f"{name}_{grid}_clean.exr"
        seconds = run("render_passes.py", path, "-o", merged, "--subpixels", grid, "--quiet", *size)
        begun = processor_seconds()
        Polyrecon().run("denoise", "-i", merged, "-o", clean, "--quiet")
        yield row(
            f"render_passes.py --subpixels {grid}", work, name, merged, clean, [seconds, processor_seconds() - begun]
        )
    passes, clean = work / f"{name}.passes", work / f"{name}_adaptive.exr"
    shutil.rmtree(passes, ignore_errors=True)
    options = ["--budget-spp", ADAPTIVE_SAMPLES, "--passes-dir", passes, "--quiet"]
    seconds = run("adaptive.py", path, "-o", clean, *options, *size)
    yield row(f"adaptive.py --budget-spp {ADAPTIVE_SAMPLES}", work, name, passes / "merged.exr", clean, [seconds])
    pictures = [work / f"{name}_4.exr", work / f"{name}_4_clean.exr", work / f"{name}_ref.exr"]
    Polyrecon().run("preview", *pictures, "-o", work / f"{name}.png")


def row(what, work, name, merged, clean, seconds):
    samples = exr.read(merged)["Sample Count.X"].mean()
    spent = " + ".join(f"{s:.0f}" for s in seconds)
    return (
        f"  {what:28} {samples:5.1f} spp  mean {relative_mse(work, name, merged):.2e}"
        f"  clean {relative_mse(work, name, clean):.2e}  {spent} processor seconds"
    )


def relative_mse(work, name, path):
    """As `polyrecon compare` has it, the reference's own variance taken off."""
    found, reference_channels = exr.read(path), exr.read(work / f"{name}_ref.exr")
    errors = []
    for c in "RGB":
        image, truth = found[f"Combined.{c}"].astype(float), reference_channels[f"Combined.{c}"].astype(float)
        errors.append(((image - truth) ** 2 - reference_channels[f"Combined Variance.{c}"]) / (truth**2 + 0.01))
    return float(np.mean(errors))


def run(driver, *words):
    """Runs a driver; returns its processor seconds, with those of all that it started."""
    begun = processor_seconds()
    subprocess.run([sys.executable, "-B", HERE / driver, *map(str, words)], check=True)
    return processor_seconds() - begun


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


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
        channels.update(
            {f"Combined{' Variance' * (kind == 'variance')}.{c}": planes[..., i] for i, c in enumerate("RGB")}
        )
    exr.write(target, channels)
    return target


if __name__ == "__main__":
    sys.exit(main())
