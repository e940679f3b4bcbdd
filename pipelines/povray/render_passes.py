#!/usr/bin/env python3
"""Renders a POV-Ray scene with the layers that `polyrecon denoise` uses: picture, albedo, normal, visibility and depth,
as far as the scene needs them, each with mean, variance and halves. The scene's files are not changed.

examples:
  %(prog)s scene.pov -o merged.exr -- +W640 +H360
  %(prog)s scene.pov -o merged.exr --subpixels 8 -- scene.ini +Ltextures Declare=Night=1
  polyrecon denoise -i merged.exr -o clean.exr"""

if not __package__:  # run as a script from a checkout
    import pathlib
    import sys

    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.povray"

import argparse
import pathlib
import shlex
import sys
import time

from ..common.modules import RENDERING, required

with required("polyrecon-povray-passes", RENDERING):
    import numpy as np

    from ..common import exr, outputs
    from ..common.arguments import Parser, add_pass_timeout
    from ..common.command import add_output_arguments
    from ..common.errors import run_main
    from ..common.layer_names import HALF_A_SUFFIX, HALF_B_SUFFIX, VARIANCE_SUFFIX
    from ..common.terminal import print_lines, size_text
    from ..loop.renderer import SAMPLE_COUNT
    from . import passes
    from .crops import cover
    from .scene import Scene
    from .subpixels import Estimate, estimate, join


FIRST_GRID = 2  # subpixels per side of a pixel in the first pass and in the feature passes
NOISE_LIMIT = 0.005  # standard error of the first pass, relative to the brightness, above which there is noise
NOISE_BLOCK = 8  # pixels per side of a block; half of them must be noisy, so that edges do not count


def main(words=None):
    return run_main("polyrecon-povray-passes", _main, words)


def split_words(words):
    """(words of the driver, options of POV-Ray), which the first -- separates."""
    words = list(sys.argv[1:] if words is None else words)
    at = words.index("--") if "--" in words else len(words)
    return words[:at], words[at + 1 :]


def _main(words):
    words, povray_options = split_words(words)
    options = _parser().parse_args(words)
    outputs.check_ending(options.output, ".exr")
    outputs.check_new([options.output], options.overwrite)
    outputs.check_writable([options.output])
    detail = print_lines if options.verbose else (lambda *_: None)
    begun = time.monotonic()
    with Scene(options.scene, povray_options, options.povray, options.pass_timeout) as scene:
        detail(f"{options.scene}: {scene.width} x {scene.height}, parsed in {scene.parse_seconds:.1f} s")
        choice = passes.choose_passes(scene, options.camera)
        for decision in choice.decisions:
            detail(f"  {'yes' if decision.run else 'no ':3} {decision.name}: {decision.reason}")
        detail(f"  decided in {time.monotonic() - begun:.1f} s")
        beauty, samples = render_beauty(scene, options.subpixels, detail)
        detail(f"  beauty after {time.monotonic() - begun:.1f} s")
        features = passes.render_features(scene, choice, FIRST_GRID)
        layers = {"Combined": beauty, **features}
        exr.write(options.output, {**channels(layers), SAMPLE_COUNT: samples}, {"Software": "polyrecon, POV-Ray"})
        if not options.quiet:
            found = ", ".join(decision.name for decision in choice.decisions if decision.run) or "none"
            print_lines(
                f"{options.output}: {scene.width} x {scene.height}, {scene.version}, {samples.mean():.3g} samples per "
                f"pixel; features: {found}",
                f"  {size_text(pathlib.Path(options.output).stat().st_size)}, {time.monotonic() - begun:.1f} s",
                f"  next: polyrecon denoise -i {shlex.quote(options.output)} --outputs layers",
            )


def render_beauty(scene, grid, say=lambda text: None):
    """Renders FIRST_GRID^2 subpixels of every pixel, and grid^2 more where these show noise; returns (Estimate, samples
    of each pixel)."""
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
    """The pixels of blocks whose median standard error is above NOISE_LIMIT, and of their neighbouring blocks.

    The error comes from the difference of the halves, which have an even change across the pixel in common."""
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
    """Sets the variance to 0 and the halves to the mean in these pixels, so that the reconstruction does not change
    them.

    Without noise, subpixels differ by edges and highlights alone. These cannot be distinguished from fireflies, their
    variance is several times the error of a grid's mean, and the features have the same errors as the picture, as they
    come from the same subpixels."""
    where = where[..., None]
    halves = (np.where(where, beauty.mean, half) for half in (beauty.a, beauty.b))
    return Estimate(beauty.mean, np.where(where, 0, beauty.variance), *halves)


def channels(layers):
    """{channel: plane} from {layer: Estimate}, with the names that `polyrecon` knows."""
    found = {}
    for name, layer in layers.items():
        suffixes = {"Denoising Normal": "XYZ", "Denoising Depth": "Z", "Visibility": "X"}.get(name, "RGB")
        kinds = {
            "": layer.mean,
            VARIANCE_SUFFIX: layer.variance,
            HALF_A_SUFFIX: layer.a,
            HALF_B_SUFFIX: layer.b,
        }
        for kind, planes in kinds.items():
            found.update({f"{name}{kind}.{suffix}": planes[..., i] for i, suffix in enumerate(suffixes)})
    return found


def add_povray_arguments(parser):
    """Adds the options that both drivers have."""
    parser.add_argument(
        "--camera", metavar="X,Y,Z", type=_place, help="place of the camera, if it is not found in the scene file"
    )
    parser.add_argument("--povray", default="povray", metavar="PATH", help="POV-Ray, a path or a name on the PATH")
    add_pass_timeout(parser)


def _place(text):
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: must be three numbers with commas between") from None
    return f"{x!r},{y!r},{z!r}"


def _grid(text):
    grid = int(text)
    if not FIRST_GRID <= grid <= 64:
        raise ValueError
    return grid


def _parser():
    parser = Parser(
        "polyrecon-povray-passes",
        usage="%(prog)s SCENE.pov -o OUT.exr [options] [-- POV-Ray's options]",
        description=__doc__,
    )
    parser.add_argument("scene", metavar="SCENE.pov", help="the scene; it is never changed")
    add_output_arguments(parser)
    add_povray_arguments(parser)
    parser.add_argument(
        "--subpixels",
        type=_grid,
        default=4,
        metavar="N",
        help=f"N x N more samples of pixels in which {FIRST_GRID} x {FIRST_GRID} show noise, 2 to 64",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
