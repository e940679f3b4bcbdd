#!/usr/bin/env python3
"""Compares the loop's noisy mean over many seeds of a tiny frame with the uniform mean. Prints z values; the exit code
is 1 if the means differ. 200 seeds take some minutes, so this is not a test of ctest:

    POLYRECON=build/release/src/polyrecon build/venv/bin/python3 tests/pipelines/blender/unbiased.py --seeds 200
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3]))
from pipelines.blender.renderer import BlenderRenderer
from pipelines.common import exr
from pipelines.common.command import Frame
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.common.progress import Progress
from pipelines.loop import adaptive
from pipelines.loop.budget import Budget
from pipelines.loop.frame import Settings

MAKE_SCENE = pathlib.Path(__file__).with_name("make_scene.py")


class Seeded(BlenderRenderer):
    """Shifts the numbers of the samples, so that runs with another offset have other samples, as with another seed."""

    offset = 0

    def _render(self, **job):
        return super()._render(**{**job, "first": job["first"] + self.offset})


def picture(path):
    channels = exr.read(path, lambda name: name.startswith("ViewLayer.Combined."))
    return np.stack([channels[f"ViewLayer.Combined.{c}"] for c in "RGB"], -1).astype(float)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--spp", type=int, default=24)
    parser.add_argument("--kind", default="caustic", help="scene of make_scene.py")
    options = parser.parse_args()
    polyrecon = Polyrecon()
    adapted, uniform, counts = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        scene = folder / "scene.blend"
        subprocess.run([sys.executable, MAKE_SCENE, scene, options.kind], check=True, stdout=subprocess.DEVNULL)
        renderer = Seeded(scene, "bpy")
        try:
            for seed in range(options.seeds):
                renderer.offset = seed * 4096
                passes = folder / f"p{seed}"
                settings = Settings(Frame(None, passes, folder / "o.exr"), Budget(samples=options.spp), quality="draft")
                result = adaptive.run(renderer, polyrecon, settings, Progress("none"))
                adapted.append(picture(result.merged))
                counts.append(exr.read(result.merged)["ViewLayer.Sample Count.X"])
                renderer.uniform(2048, options.spp, folder / "u.exr")
                uniform.append(picture(folder / "u.exr"))
        finally:
            renderer.close()
    adapted, uniform = np.array(adapted), np.array(uniform)
    n = options.seeds
    error = np.sqrt(adapted.var(0, ddof=1) / n + uniform.var(0, ddof=1) / n)
    z = ((adapted.mean(0) - uniform.mean(0)) / np.maximum(error, 1e-9))[error > 1e-9]
    frames = [run.mean((1, 2, 3)) for run in (adapted, uniform)]
    whole = (frames[0].mean() - frames[1].mean()) / np.sqrt(sum(f.var(ddof=1) / n for f in frames))
    print(f"{n} seeds, {np.mean(counts):.1f} samples per pixel, {np.min(counts):.0f} to {np.max(counts):.0f}")
    print(f"frame mean: adaptive {frames[0].mean():.6f}, uniform {frames[1].mean():.6f}: z = {whole:.2f}")
    print(
        f"pixels: rms of z {np.sqrt((z**2).mean()):.3f} (1 expected), mean {z.mean():+.3f}, "
        f"beyond 3: {(abs(z) > 3).mean():.4f} (0.0027 expected)"
    )
    variance = [np.maximum(run.var(0), 1e-12) for run in (adapted, uniform)]
    ratios = [np.median(variance[0] / variance[1]), variance[0].mean() / variance[1].mean()]
    print(
        f"variance of a pixel, adaptive / uniform: median {ratios[0]:.3f}; "
        f"of their means, which single samples may dominate: {ratios[1]:.3f}"
    )
    return int(abs(whole) > 3 or np.sqrt((z**2).mean()) > 1.1)


if __name__ == "__main__":
    sys.exit(main())
