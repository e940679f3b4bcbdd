"""POV-Ray as a Renderer of the adaptive loop.

The samples of a pixel are subpixels of square grids. The noise of a subpixel depends on its place and size alone, so no
grid is used twice in one pixel. The first pass is one grid. The white fields of its chessboard of subpixels are the
first half of the sequence, the black ones the second. Extra samples are crops with other grids."""

import dataclasses
import json
import math
import time

import numpy as np

from ..common import exr
from ..common.errors import DriverError, ExitCode
from ..common.rectangles import first_of_fullest_rows
from ..common.scene_inputs import SceneInputs
from ..loop.renderer import SAMPLE_COUNT, Audit, Renderer, Switch
from . import inputs, passes
from .crops import cover
from .render_passes import FIRST_GRID, channels
from .scene import CONCURRENT_RUNS, Scene, Shot
from .subpixels import blocks

LARGEST_GRID = 64
MAX_OVER_WANTED = 2.0  # limit of a crop's samples over those that its counts want, if other crops left some over
OF_A_FRAME = ("scene", "inputs", "choice", "first", "features", "seconds_per_sample", "audit")
GRIDS = "polyreconGrids"  # attribute of a part: [[x0, y0, x1, y1, n], ...] in JSON


class PovrayRenderer(Renderer):
    """Renders the frames of a scene.

    path, options, povray, timeout: see Scene. first_pass: samples of a pixel in the uniform pass, the square of an even
    number. camera: its place, "x,y,z", or None."""

    extra_in_sequence = False  # See _free_grids.
    completes = True

    def __init__(self, path, options, povray, timeout, first_pass, camera=None):
        self.path, self.options, self.povray, self.timeout, self.camera = path, options, povray, timeout, camera
        self.grid = math.isqrt(first_pass)
        if self.grid**2 != first_pass or self.grid % 2 or not 2 <= self.grid <= LARGEST_GRID:
            raise DriverError(
                ExitCode.USAGE, f"--first-pass {first_pass}: must be the square of an even number: 4, 16, 36, 64"
            )
        self.scene = None
        self.opened = {}  # What is known of each frame: see begin

    def begin(self, frame):
        """The frames of a shot take turns. What was made of a frame stays until the end, but for the subpixels of the
        first pass, which are in its parts then."""
        if not self.shot:
            self.close()
        if self.scene:
            self.first = None
            self.opened[self.frame] = {name: getattr(self, name) for name in OF_A_FRAME}
            self.scene = None
        self.frame = frame
        if frame in self.opened:
            vars(self).update(self.opened.pop(frame))
            return self.audit
        self.audit = self._open(frame)
        return self.audit

    def _open(self, frame):
        options = [*self.options, *([f"+SF{frame}", f"+EF{frame}"] if frame is not None else [])]
        self.inputs = SceneInputs()
        input_digests = self.inputs.begin_frame(inputs.used(self.path, options))
        self.scene = Scene(self.path, options, self.povray, self.timeout)
        self.name = self.scene.version
        self.choice = passes.choose_passes(self.scene, self.camera)
        self.first = None  # subpixels of the first pass
        self.features = None  # channels of the feature passes
        self.seconds_per_sample = 0.0
        return Audit(
            width=self.scene.width,
            height=self.scene.height,
            beauty="Combined",
            switches=[Switch("antialiasing", "off", "the samples are subpixels")],
            passes={decision.name: decision.reason for decision in self.choice.decisions if decision.run},
            notes=self._notes(),
            details=[
                f"no {decision.name}: {decision.reason}" for decision in self.choice.decisions if not decision.run
            ],
            method="crops with grids of subpixels",
            inputs=input_digests,
            features=[decision.name for decision in self.choice.decisions if decision.run],
        )

    def _notes(self):
        why = self.scene.not_confined
        return [f"POV-Ray can write where the scene says: {why}"] if why else []

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
        per_sample = self.seconds_per_sample or 1e-5  # Unknown after a resume: that of a simple scene.
        crops = cover(np.ceil(np.sqrt(counts)), self.scene.parse_seconds / CONCURRENT_RUNS / per_sample)
        shots = self._shots([crop for crop, _ in crops], counts, self._used_grids(target))
        for shot, image in zip(shots, self.scene.render_all(shots)):
            rows, columns = slice(shot.crop.y0, shot.crop.y1), slice(shot.crop.x0, shot.crop.x1)
            mean[rows, columns] = blocks(image, shot.scale).mean((2, 3), dtype=np.float64)
            taken[rows, columns] = shot.scale**2
        self._write(target, mean, taken, shots)

    def complete(self, merged):
        """Adds the feature passes, which are rendered at the first call and the same for all parts."""
        if self.features is None:
            self.features = channels(passes.render_features(self.scene, self.choice, FIRST_GRID))
        exr.write(merged, {**exr.read(merged), **self.features})

    def close(self):
        for scene in [self.scene, *(known["scene"] for known in self.opened.values())]:
            if scene:
                scene.close()
        self.scene, self.opened = None, {}

    def _shots(self, crops, counts, used):
        """Each crop with a grid that none of its pixels has had, and with no more samples than its counts want and
        earlier crops left over. If even the smallest such grid has more, the crop loses rows."""
        shots, left = [], 0.0
        for crop in crops:
            wanted = float(counts[crop.y0 : crop.y1, crop.x0 : crop.x1].sum())
            area = crop.width * crop.height
            most = min(wanted + left, MAX_OVER_WANTED * wanted) / area
            free = self._free_grids(crop, used)
            fitting = [n for n in free if n * n <= most]
            rows = crop.height if fitting else int(most * area) // (free[0] ** 2 * crop.width)
            if crop is crops[-1] and not shots:
                rows = max(rows, 1)  # A pass is never empty.
            if rows:
                grid = max(fitting, default=free[0])
                shots.append(Shot(scale=grid, crop=_rows_that_want_most(crop, counts, rows)))
                left -= grid**2 * rows * crop.width
            left += wanted
        return shots

    def _free_grids(self, crop, used):
        taken = {n for other, n in used if _touch(crop, other)} | {self.grid}
        return [n for n in range(2, LARGEST_GRID + 1) if n not in taken]

    def _used_grids(self, target):
        """[(box, n)] of the extra parts in the folder, without `target`, which an interrupted run may have left."""
        used = []
        for path in target.parent.glob("part_*.exr"):
            if path != target:
                used += _grids_of(path)
        return used

    def _write(self, target, mean, counts, shots):
        self.inputs.check()
        rows = [[s.crop.x0, s.crop.y0, s.crop.x1, s.crop.y1, s.scale] for s in shots]
        beauty = {f"Combined.{c}": mean[..., i] for i, c in enumerate("RGB")}
        exr.write(target, {**beauty, SAMPLE_COUNT: counts}, {GRIDS: json.dumps(rows)})


def _grids_of(part):
    """[(box, n)] of a part."""
    try:
        rows = json.loads(exr.metadata(part).get(GRIDS, "[]"))
        return [(list(map(int, box)), int(n)) for *box, n in rows if len(box) == 4]
    except (ValueError, TypeError, RecursionError) as error:
        raise DriverError(ExitCode.BAD_INPUT, f"{part}: the attribute {GRIDS} is damaged: {error}") from error


def field_order(n):
    """The fields (y, x) of an n x n grid: the white ones of the chessboard, then the black ones.

    Every other field is half a grid away from the one before it, in both directions, so that two in a row are well
    spread."""
    order = []
    for colour in (0, 1):
        for y in range(n // 2):
            for x in range(n):
                if (x + y) % 2 == colour:
                    order += [(y, x), (y + n // 2, (x + n // 2) % n)]
    return order


def _rows_that_want_most(crop, counts, rows):
    """The part of a crop, of so many rows, whose counts are largest."""
    first = crop.y0 + first_of_fullest_rows(counts[crop.y0 : crop.y1, crop.x0 : crop.x1], rows)
    return dataclasses.replace(crop, y0=first, y1=first + rows)


def _touch(crop, box):
    return crop.x0 < box[2] and box[0] < crop.x1 and crop.y0 < box[3] and box[1] < crop.y1
