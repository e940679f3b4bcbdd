#!/usr/bin/env python3
"""The shared budget of a shot against the same budget divided evenly between its frames: mean relMSE against
references.

  build/venv/bin/python3 tests/bench/blender/shot.py parade --frames 4-9 --spp 32"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import unittest.mock

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3]))
from pipelines.blender.renderer import BlenderRenderer
from pipelines.common import exr
from pipelines.common.command import Frame
from pipelines.common.digests import digest
from pipelines.common.frame_names import parse_ranges
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.common.progress import Progress
from pipelines.loop import shot
from pipelines.loop.budget import Budget
from pipelines.loop.frame import Settings
from tests.bench import relmse

ROOT = pathlib.Path(__file__).resolve().parents[3]
REFERENCE_SEED = 1 << 20  # First sample of the references: other sequences than those of the loop


def arguments(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", help="a scene of samples/scenes, or a .blend file")
    parser.add_argument("--frames", default="1-6")
    parser.add_argument("--size", default="96x54", help="of a scene of samples/scenes")
    budget = parser.add_mutually_exclusive_group()
    budget.add_argument("--spp", type=float, default=32)
    budget.add_argument("--seconds", type=float)
    parser.add_argument("--quality", default="standard")
    parser.add_argument("--reference-spp", type=int, default=512)
    return parser.parse_args(words)


def blend_file(scene, size, folder):
    if scene.endswith(".blend"):
        return pathlib.Path(scene)
    path = folder / "scene.blend"
    words = [ROOT / "samples" / "scenes" / "render.py", scene, folder / "unused.exr", "--size", size]
    words += ["--spp", 1, "--save-blend", path]
    subprocess.run([sys.executable, *map(str, words)], check=True, stdout=subprocess.DEVNULL)
    return path


def render(scene, folder, options, even):
    """The shot's pictures and result. even: whether the frames get the same."""
    numbers = parse_ranges(options.frames)
    budget = Budget(seconds=options.seconds) if options.seconds else Budget(samples=options.spp)
    settings = [
        Settings(
            Frame(n, folder / f"{n}.passes", folder / f"{n}.exr"),
            budget,
            quality=options.quality,
            identity={"scene": digest(scene)},
            shot=tuple(numbers),
        )
        for n in numbers
    ]
    renderer = BlenderRenderer(scene, "bpy")
    try:
        if even:
            with unittest.mock.patch("pipelines.loop.sharing.shares_of", divided_evenly):
                result = shot.run(renderer, Polyrecon(), settings, Progress("none"))
        else:
            result = shot.run(renderer, Polyrecon(), settings, Progress("none"))
    finally:
        renderer.close()
    return [picture(entry.files.output) for entry in settings], result


def divided_evenly(frames, left):
    """In place of sharing.shares_of: levels what the frames have spent."""
    level = (left + sum(frame.spent for frame in frames)) / len(frames)
    return [max(0.0, level - frame.spent) for frame in frames]


def references(scene, folder, options):
    """(picture, variance of its mean) of each frame."""
    renderer = BlenderRenderer(scene, "bpy")
    renderer.shot = True
    found = []
    try:
        for number in parse_ranges(options.frames):
            renderer.begin(number)
            halves = []
            for half in range(2):
                part = folder / f"reference_{half}.exr"
                each = options.reference_spp // 2
                renderer.uniform(REFERENCE_SEED + half * each, each, part)
                halves.append(picture(part))
            found.append(((halves[0] + halves[1]) / 2, (halves[0] - halves[1]) ** 2 / 4))
    finally:
        renderer.close()
    return found


def picture(path):
    channels = exr.read(path, lambda name: name.endswith((".Combined.R", ".Combined.G", ".Combined.B")))
    return np.stack(list(channels.values()), -1).astype(float)


def main(words=None):
    options = arguments(words)
    numbers = parse_ranges(options.frames)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = blend_file(options.scene, options.size, folder)
        true = references(scene, folder, options)
        means = {}
        for way, even in (("shared", False), ("even", True)):
            pictures, result = render(scene, folder / way, options, even)
            errors = [relmse.relative_squares(a, *b).mean() for a, b in zip(pictures, true)]
            means[way] = np.mean(errors)
            rows = zip(numbers, errors, (frame for _, frame in result.frames))
            print(f"{way}: mean relMSE {means[way]:.5f}, {result.samples:.1f} spp, {result.seconds:.0f} s")
            for number, error, frame in rows:
                print(f"  frame {number}: {frame.samples:.1f} spp, relMSE {error:.5f}, estimated {frame.error:.5f}")
    print(f"shared / even: {means['shared'] / means['even']:.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
