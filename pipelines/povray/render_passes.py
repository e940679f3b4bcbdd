#!/usr/bin/env python3
"""Renders a POV-Ray scene with what `polyrecon denoise` wants beside the picture: mean, variance and halves of supersampled
renders, albedo, normal, visibility, depth, as far as the scene calls for them. The scene's files are not touched."""

if not __package__:  # run as a script from a checkout
    import pathlib
    import sys

    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    __package__ = "pipelines.povray"

import argparse
import sys
import time

import numpy as np

from ..common import exr
from ..common.arguments import positive
from ..common.errors import run_main
from ..loop.renderer import SAMPLE_COUNT
from . import passes
from .crops import cover
from .scene import Scene
from .subpixels import Estimate, estimate, join

FIRST_GRID = 2  # subpixels a side of the first pass and of the feature passes
NOISE_LIMIT = 0.005  # standard error of the first pass, relative to the brightness, that counts as noise
NOISE_BLOCK = 8  # pixels a side: half of them have to be noisy, so that the edges of things do not count


def main(words=None):
    return run_main("render_passes.py", _main, words)


def split_words(words):
    """(our words, POV-Ray's): what follows the first -- is POV-Ray's."""
    words = list(sys.argv[1:] if words is None else words)
    at = words.index("--") if "--" in words else len(words)
    return words[:at], words[at + 1 :]


def _main(words):
    ours, povrays = split_words(words)
    options = _parser().parse_args(ours)
    say = (lambda *_: None) if options.quiet else (lambda text: print(text, flush=True))
    with Scene(options.scene, povrays, options.povray, options.timeout) as scene:
        say(f"{options.scene}: {scene.width} x {scene.height}, parsed in {scene.parse_seconds:.1f} s")
        begun = time.monotonic()
        plan = passes.make_plan(scene, options.camera)
        for decision in plan.decisions:
            say(f"  {'yes' if decision.run else 'no ':3} {decision.effect}: {decision.reason}")
        say(f"  decided in {time.monotonic() - begun:.1f} s")

        begun = time.monotonic()
        beauty, samples = render_beauty(scene, options.subpixels, say)
        say(f"  beauty: {samples.mean():.1f} samples per pixel in {time.monotonic() - begun:.1f} s")
        begun = time.monotonic()
        features = passes.render_features(scene, plan, FIRST_GRID)
        say(f"  {len(features)} feature passes in {time.monotonic() - begun:.1f} s")
        layers = {"Combined": beauty, **features}
        exr.write(options.output, {**channels(layers), SAMPLE_COUNT: samples}, {"Software": "polyrecon, POV-Ray"})


def render_beauty(scene, grid, say=lambda text: None):
    """The picture: FIRST_GRID squared subpixels of every pixel, and grid squared more where these show noise.
    Returns (Estimate, samples of each pixel)."""
    begun = time.monotonic()
    beauty = estimate(scene.render(FIRST_GRID), FIRST_GRID)
    samples = np.full(beauty.mean.shape[:2], FIRST_GRID**2, np.float32)
    per_sample = max(time.monotonic() - begun - scene.parse_seconds, 1e-3) / samples.sum()
    noisy = noise(beauty)
    beauty = without_variance(beauty, ~noisy)
    if grid <= FIRST_GRID:
        return beauty, samples
    say(f"  {'yes' if noisy.any() else 'no '} more subpixels: {noisy.mean():.0%} of the frame is noisy")
    for crop, n in cover(noisy * grid, scene.parse_seconds / per_sample):
        more = estimate(scene.render(n, crop=crop), n)
        rows, columns = slice(crop.y0, crop.y1), slice(crop.x0, crop.x1)
        joined = join(beauty.crop(rows, columns), FIRST_GRID**2, more, n * n)
        beauty.paste(rows, columns, joined)
        samples[rows, columns] += n * n
    return beauty, samples


def noise(beauty):
    """Which pixels lie in blocks whose median standard error is above NOISE_LIMIT, or beside such a block. The error is
    that of the halves' difference: what changes evenly across a pixel is the same in both."""
    error = np.sqrt(((beauty.a - beauty.b) ** 2).mean(-1)) / 2 / (beauty.mean.mean(-1) + 0.1)
    height, width = error.shape
    up = [-(-side // NOISE_BLOCK) for side in error.shape]
    padded = np.pad(error, [(0, n * NOISE_BLOCK - side) for n, side in zip(up, error.shape)], mode="edge")
    blocks = padded.reshape(up[0], NOISE_BLOCK, up[1], NOISE_BLOCK)
    noisy = np.pad(np.median(blocks, axis=(1, 3)) > NOISE_LIMIT, 1)
    near = np.zeros(up, bool)
    for dy in range(3):
        for dx in range(3):
            near |= noisy[dy : dy + up[0], dx : dx + up[1]]
    return near.repeat(NOISE_BLOCK, 0).repeat(NOISE_BLOCK, 1)[:height, :width]


def without_variance(beauty, where):
    """There the reconstruction keeps the pixels as they are. Where nothing is noisy the subpixels differ by edges and
    highlights alone: chance does not tell them from fireflies, their variance is several times the error of a grid's mean,
    and the features, taken from the same subpixels, err with the picture."""
    where = where[..., None]
    halves = (np.where(where, beauty.mean, half) for half in (beauty.a, beauty.b))
    return Estimate(beauty.mean, np.where(where, 0, beauty.variance), *halves)


def channels(layers):
    """{layer: Estimate} as channels, with the names that `polyrecon denoise` and `polyrecon merge` know."""
    found = {}
    for name, layer in layers.items():
        suffixes = {"Denoising Normal": "XYZ", "Denoising Depth": "Z", "Visibility": "X"}.get(name, "RGB")
        for kind, planes in (("", layer.mean), (" Variance", layer.variance), (" A", layer.a), (" B", layer.b)):
            found.update({f"{name}{kind}.{suffix}": planes[..., i] for i, suffix in enumerate(suffixes)})
    return found


def add_povray_arguments(parser):
    """The options that both drivers have."""
    parser.add_argument(
        "--camera", metavar="X,Y,Z", type=_place, help="place of the camera, where the scene does not tell it"
    )
    parser.add_argument("--povray", default="povray", metavar="PATH", help="the program (povray)")
    parser.add_argument(
        "--timeout", type=positive, metavar="SECONDS", help="longest time of one POV-Ray run (no limit)"
    )


def _place(text):
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError("three numbers with commas between") from None
    return f"{x!r},{y!r},{z!r}"


def _grid(text):
    grid = int(text)
    if not FIRST_GRID <= grid <= 64:
        raise ValueError
    return grid


def _parser():
    parser = argparse.ArgumentParser(
        prog="render_passes.py",
        description=__doc__,
        usage="%(prog)s SCENE.pov -o FILE.exr [options] [-- POV-Ray's options]",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="examples:\n"
        "  render_passes.py scene.pov -o merged.exr -- +W640 +H360\n"
        "  render_passes.py scene.pov -o merged.exr --subpixels 8 -- scene.ini +Ltextures Declare=Night=1\n"
        "  polyrecon denoise -i merged.exr -o clean.exr",
    )
    parser.add_argument("scene", metavar="SCENE.pov")
    parser.add_argument("-o", "--output", required=True, metavar="FILE.exr")
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")
    add_povray_arguments(parser)
    parser.add_argument(
        "--subpixels",
        type=_grid,
        default=4,
        metavar="N",
        help=f"N x N more samples of each pixel where {FIRST_GRID} x {FIRST_GRID} show noise, 2 to 64 (4)",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
