"""A renderer without a scene, of an image and a noise that are known, so that the loop's statistics can be tested. As a
script it runs the loop: synthetic.py FOLDER BUDGET_SPP [--resume]."""

import pathlib
import sys

import numpy as np

from pipelines.common import exr
from pipelines.common.command import Frame
from pipelines.common.digests import digest
from pipelines.common.errors import run_main
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.common.progress import Progress
from pipelines.loop import adaptive
from pipelines.loop.budget import Budget
from pipelines.loop.frame import Settings
from pipelines.loop.renderer import RENDER_SECONDS, SAMPLE_COUNT, Audit, Renderer


class SyntheticRenderer(Renderer):
    """Sample s of a pixel is its mean times a gamma variate of mean 1 and variance `spread`, drawn by (seed, s, pixel).
    The variates are skewed, as Monte Carlo samples are. The left half of the frame is noisy, the right half nearly
    noise-free. Samples of the lower half cost three times as much."""

    name = "synthetic"

    def __init__(self, width=96, height=64, seed=1):
        y, x = np.mgrid[:height, :width]
        self.mean = 0.5 + 0.4 * np.sin(x / 9.0) * np.cos(y / 7.0)
        self.spread = np.where(x < width / 2, 8.0, 0.05)
        self.seconds = np.where(y < height / 2, 1.0, 3.0)
        self.seed = seed
        self.ranges = []

    def begin(self, frame):
        height, width = self.mean.shape
        return Audit(width, height, "L.Combined", method="single pixels", inputs={__file__: digest(__file__)})

    def sample(self, number):
        random = np.random.Generator(np.random.Philox(key=[self.seed, number]))
        return self.mean * random.gamma(1 / self.spread, self.spread)

    def uniform(self, first, samples, target):
        self.extra(first, np.full(self.mean.shape, samples), target)

    def extra(self, first, counts, target):
        self.ranges.append((first, int(counts.max())))
        total = np.zeros(self.mean.shape)
        for number in range(int(counts.max())):
            total += np.where(counts > number, self.sample(first + number), 0)
        picture = total / np.maximum(counts, 1)
        part = {f"L.Combined.{c}": picture for c in "RGB"}
        part |= {f"L.Denoising Albedo.{c}": self.mean for c in "RGB"}
        part[f"L.{SAMPLE_COUNT}"] = counts
        part[f"L.{RENDER_SECONDS}"] = counts * self.seconds
        exr.write(target, part)


def loop(
    folder,
    budget,
    resume=False,
    seed=1,
    quality="draft",
    renderer=None,
    max_rounds=8,
    scene=None,
    frame=None,
    style="none",
    **size,
):
    folder = pathlib.Path(folder)
    settings = Settings(
        Frame(frame, folder / "passes", folder / "out.exr"),
        budget,
        resume=resume,
        quality=quality,
        max_rounds=max_rounds,
        scene=str(scene) if scene else None,
    )
    renderer = renderer or SyntheticRenderer(seed=seed, **size)
    return renderer, adaptive.run(renderer, Polyrecon(), settings, Progress(style))


def main(words):
    loop(words[0], Budget(samples=float(words[1])), resume="--resume" in words)


if __name__ == "__main__":
    sys.exit(run_main("synthetic", main, sys.argv[1:]))
