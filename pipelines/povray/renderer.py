"""POV-Ray as a Renderer of the loop.

The samples of a pixel are subpixels of square grids, no grid twice in one pixel: the noise of a subpixel comes with its place
and size. The first pass is one grid; its white fields, chessboard-wise, are the first half of the sequence, its black ones the
second. Extra samples come as crops with other grids.
"""

import dataclasses
import json
import math
import time

import numpy as np

from ..common import exr
from ..common.errors import DriverError, ExitCode
from ..loop.renderer import SAMPLE_COUNT, Audit, Renderer, Switch
from . import passes
from .crops import cover
from .render_passes import FIRST_GRID, channels
from .scene import AT_ONCE, Scene, Shot
from .subpixels import blocks

LARGEST_GRID = 64
MOST_OVER_MEAN = 2.0  # what a crop takes at most of what others left over, in its own mean count
GRIDS = "polyreconGrids"  # attribute of a part: [[x0, y0, x1, y1, n], ...] in JSON


class PovrayRenderer(Renderer):
    """path, options, povray, timeout: see Scene. first_pass: samples of a pixel in the uniform pass, an even number
    squared. camera: its place, "x,y,z", or None."""

    def __init__(self, path, options, povray, timeout, first_pass, camera=None):
        self.path, self.options, self.povray, self.timeout, self.camera = path, options, povray, timeout, camera
        self.grid = math.isqrt(first_pass)
        if self.grid**2 != first_pass or self.grid % 2 or not 2 <= self.grid <= LARGEST_GRID:
            raise DriverError(ExitCode.USAGE, f"--first-pass {first_pass}: 4, 16, 36, 64: an even number squared")
        self.scene = None

    def begin(self, frame):
        self.close()
        options = [*self.options, *([f"+SF{frame}", f"+EF{frame}"] if frame is not None else [])]
        self.scene = Scene(self.path, options, self.povray, self.timeout)
        self.name = self.scene.version
        self.plan = passes.make_plan(self.scene, self.camera)
        self.first = self.features = None  # subpixels of the first pass; channels of the feature passes
        self.seconds_per_sample = 0.0
        return Audit(
            width=self.scene.width,
            height=self.scene.height,
            beauty="Combined",
            switches=[Switch("antialiasing", "off", "the samples are subpixels")],
            passes={decision.effect: decision.reason for decision in self.plan.decisions if decision.run},
            notes=[f"no {decision.effect}: {decision.reason}" for decision in self.plan.decisions if not decision.run],
            method="crops with grids of subpixels",
        )

    def uniform(self, first, samples, target):
        if self.first is None:
            begun = time.monotonic()
            self.first = self.scene.render(self.grid)
            seconds = max(time.monotonic() - begun - self.scene.parse_seconds, 1e-3)
            self.seconds_per_sample = seconds / (self.grid**2 * self.scene.width * self.scene.height)
        fields = field_order(self.grid)[first : first + samples]
        subpixels = blocks(self.first, self.grid)
        mean = np.mean([subpixels[:, :, y, x] for y, x in fields], axis=0, dtype=np.float64)
        counts = np.full(mean.shape[:2], samples, np.float32)
        self._write(target, mean, counts, [])

    def extra(self, first, counts, target):
        mean = np.zeros((*counts.shape, 3))
        taken = np.zeros(counts.shape, np.float32)
        per_sample = self.seconds_per_sample or 1e-5  # unknown after a resume: of a simple scene
        crops = cover(np.ceil(np.sqrt(counts)), self.scene.parse_seconds / AT_ONCE / per_sample)
        shots = self._shots([crop for crop, _ in crops], counts, self._used_grids(target))
        for shot, image in zip(shots, self.scene.render_all(shots)):
            rows, columns = slice(shot.crop.y0, shot.crop.y1), slice(shot.crop.x0, shot.crop.x1)
            mean[rows, columns] = blocks(image, shot.scale).mean((2, 3), dtype=np.float64)
            taken[rows, columns] = shot.scale**2
        self._write(target, mean, taken, shots)
        return int(taken.max())

    def complete(self, merged):
        """The feature passes: of all parts the same, rendered when they are first asked for."""
        if self.features is None:
            self.features = channels(passes.render_features(self.scene, self.plan, FIRST_GRID))
        exr.write(merged, {**exr.read(merged), **self.features})

    def close(self):
        if self.scene:
            self.scene.close()

    def _shots(self, crops, counts, used):
        """Each crop with a grid that is new to all of its pixels and, with what the crops before it left over, costs no more
        than its counts ask for; where even the smallest such grid does, as many rows of the crop as are paid for."""
        shots, left = [], 0.0
        for crop in crops:
            wanted = float(counts[crop.y0 : crop.y1, crop.x0 : crop.x1].sum())
            area = crop.width * crop.height
            most = min(wanted + left, MOST_OVER_MEAN * wanted) / area
            free = self._free_grids(crop, used)
            fitting = [n for n in free if n * n <= most]
            rows = crop.height if fitting else int(most * area) // (free[0] ** 2 * crop.width)
            if crop is crops[-1] and not shots:
                rows = max(rows, 1)  # a pass is never empty
            if rows:
                grid = max(fitting, default=free[0])
                shots.append(Shot(scale=grid, crop=_neediest_rows(crop, counts, rows)))
                left -= grid**2 * rows * crop.width
            left += wanted
        return shots

    def _free_grids(self, crop, used):
        taken = {n for other, n in used if _touch(crop, other)} | {self.grid}
        return [n for n in range(2, LARGEST_GRID + 1) if n not in taken]

    def _used_grids(self, target):
        """[(box, n)] of the extra parts that are there already; `target`, if it is an unfinished one's, is done anew."""
        used = []
        for path in target.parent.glob("*.exr"):
            if path != target:
                used += [(row[:4], row[4]) for row in json.loads(exr.metadata(path).get(GRIDS, "[]"))]
        return used

    def _write(self, target, mean, counts, shots):
        rows = [[s.crop.x0, s.crop.y0, s.crop.x1, s.crop.y1, s.scale] for s in shots]
        beauty = {f"Combined.{c}": mean[..., i] for i, c in enumerate("RGB")}
        exr.write(target, {**beauty, SAMPLE_COUNT: counts}, {GRIDS: json.dumps(rows)})


def field_order(n):
    """Fields (y, x) of an n x n grid: all white ones of the chessboard, then all black ones, and next to each the one that
    is half the grid away both ways, so that two numbers in a row are well spread."""
    order = []
    for colour in (0, 1):
        for y in range(n // 2):
            for x in range(n):
                if (x + y) % 2 == colour:
                    order += [(y, x), (y + n // 2, (x + n // 2) % n)]
    return order


def _neediest_rows(crop, counts, rows):
    """The part of a crop, so many rows high, that asks for most."""
    sums = np.concatenate([[0], counts[crop.y0 : crop.y1, crop.x0 : crop.x1].sum(1).cumsum()])
    first = crop.y0 + int((sums[rows:] - sums[:-rows]).argmax())
    return dataclasses.replace(crop, y0=first, y1=first + rows)


def _touch(crop, box):
    return crop.x0 < box[2] and box[0] < crop.x1 and crop.y0 < box[3] and box[1] < crop.y1
