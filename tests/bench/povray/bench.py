#!/usr/bin/env python3
"""Makes the table of POV-Ray in docs/results/adaptive.md.

For each scene: a reference of 1024 subpixels a pixel, `render_passes.py` and `polyrecon denoise`, and `adaptive.py`,
with the relMSE and the processor seconds of each. References that are in --work already are used again. With --picture
it makes the picture of docs/guide/povray.md instead."""

import argparse
import pathlib
import resource
import shutil
import subprocess
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3]))
from pipelines.common import exr
from pipelines.common.errors import run_main
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.povray.crops import Crop
from pipelines.povray.scene import Scene
from pipelines.povray.subpixels import estimate
from tests.bench.povray import gallery
from tests.bench.relmse import relative_squares

ROOT = pathlib.Path(__file__).resolve().parents[3]
DRIVERS = ROOT / "pipelines" / "povray"
EXAMPLES = pathlib.Path("/usr/share/doc/povray/examples")  # Debian: povray-examples
SCENES = {
    "still_life": (ROOT / "samples/scenes/still_life.pov", 160, 90),
    "arealit2": (EXAMPLES / "lights/arealit2.pov", 128, 96),
    "woodbox": (EXAMPLES / "advanced/woodbox.pov", 128, 96),
    "pawns": (EXAMPLES / "advanced/pawns.pov", 128, 96),
    "focalblur": (EXAMPLES / "camera/focalblur.pov", 96, 72),
}
GALLERY = [SCENES["still_life"][0]] + [
    EXAMPLES / "advanced" / name for name in ("woodbox.pov", "chess2.pov", "wineglass.pov", "glasschess/glasschess.pov")
]
REFERENCE_GRID = 32
UNIFORM_GRIDS = (4, 8)  # with the first pass of 2 x 2 this makes 20 and 68 samples where there is noise
ADAPTIVE_SAMPLES = 68
BAND = 24  # rows of the reference in one render


def main(words=None):
    return run_main("bench.py", _main, words)


def _main(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{', '.join(SCENES)} (all)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out" / "povray")
    parser.add_argument("--only-references", action="store_true", help="make nothing but the references")
    parser.add_argument(
        "--picture", type=pathlib.Path, metavar="FILE.jpg", help="write the picture of scenes and their passes here"
    )
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
    """Yields the lines of the table: driver, samples per pixel, relMSE of mean and result, processor seconds."""
    path, width, height = SCENES[name]
    size = ["--", f"+W{width}", f"+H{height}"]
    for grid in UNIFORM_GRIDS:
        merged, clean = work / f"{name}_{grid}.exr", work / f"{name}_{grid}_clean.exr"
        seconds = run("render_passes.py", path, "-o", merged, "--subpixels", grid, "--quiet", "--overwrite", *size)
        begun = processor_seconds()
        Polyrecon().run("denoise", "-i", merged, "-o", clean, "--quiet")
        yield row(
            f"render_passes.py --subpixels {grid}", work, name, merged, clean, [seconds, processor_seconds() - begun]
        )
    passes, clean = work / f"{name}.passes", work / f"{name}_adaptive.exr"
    shutil.rmtree(passes, ignore_errors=True)
    options = ["--budget-spp", ADAPTIVE_SAMPLES, "--passes-dir", passes, "--keep-passes", "--overwrite", "--quiet"]
    seconds = run("adaptive.py", path, "-o", clean, *options, *size)
    yield row(f"adaptive.py --budget-spp {ADAPTIVE_SAMPLES}", work, name, passes / "merged.exr", clean, [seconds])
    pictures = [work / f"{name}_4.exr", work / f"{name}_4_clean.exr", work / f"{name}_ref.exr"]
    Polyrecon().run("preview", *pictures, "-o", work / f"{name}.png")


def row(label, work, name, merged, clean, seconds):
    samples = exr.read(merged)["Sample Count.X"].mean()
    spent = " + ".join(f"{s:.0f}" for s in seconds)
    return (
        f"  {label:28} {samples:5.1f} spp  mean {relative_mse(work, name, merged):.2e}"
        f"  clean {relative_mse(work, name, clean):.2e}  {spent} processor seconds"
    )


def relative_mse(work, name, path):
    """relMSE as in `polyrecon compare`, less the variance of the reference."""
    found, reference_channels = exr.read(path), exr.read(work / f"{name}_ref.exr")
    errors = []
    for c in "RGB":
        image, truth = found[f"Combined.{c}"].astype(float), reference_channels[f"Combined.{c}"].astype(float)
        errors.append(relative_squares(image, truth, reference_channels[f"Combined Variance.{c}"]))
    return float(np.mean(errors))


def run(driver, *words):
    """Runs a driver; returns its processor seconds, including those of its child processes."""
    begun = processor_seconds()
    subprocess.run([sys.executable, "-B", DRIVERS / driver, *map(str, words)], check=True)
    return processor_seconds() - begun


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def reference(work, name):
    """Makes NAME_ref.exr if it is missing: the picture and the variance of its mean."""
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
