"""Sample counts as masked passes, each over the smallest box that holds its pixels."""

import dataclasses
import itertools
import math
import os

import numpy as np
import OpenImageIO as oiio

from ..common.errors import DriverError, ExitCode

SUBPIXELS = 4
# What a pass and each pixel of its box cost in addition to the samples, in samples outside the mask
# (docs/lab/2026-11-27-loop-seconds.md).
PASS, PIXEL = 100_000, 2.5
LEAST_SIDE, PLACES = 8, 16  # of a box that is cut, and tried on each of its sides


@dataclasses.dataclass
class Pass:
    skip: int  # samples of the sequence before this pass's
    samples: int
    box: tuple  # x0, y0, x1, y1 in pixels from the top left, end excluded
    inside: np.ndarray  # bool, of the box's shape: pixels whose samples count


def bounding_box(inside):
    rows, columns = np.flatnonzero(inside.any(1)), np.flatnonzero(inside.any(0))
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1


def plan(counts):
    """Passes that lie one in another: all pixels with samples take those of the lowest count, those that ask for more go on in
    the sequence up to the next higher count, and so on. A border between two counts thus has one rim, on one side, and
    of the samples that the two differ by; with a pass for each count it would have two, of all samples."""
    passes, done = [], 0
    for count in np.unique(counts[counts > 0]).astype(int):
        inside, samples = counts >= count, int(count) - done
        for box in _boxes(inside, bounding_box(inside), samples)[1]:
            x0, y0, x1, y1 = box
            passes.append(Pass(done, samples, box, inside[y0:y1, x0:x1]))
        done = int(count)
    return passes


def _boxes(inside, box, samples):
    """(cost, boxes) of the cheaper one of: the box whole, the box cut in two at its best place and either part again."""
    x0, y0, x1, y1 = box
    whole = PASS + (x1 - x0) * (y1 - y0) * (samples + PIXEL), [box]
    if whole[0] <= 3 * PASS:  # two passes and what is in them cost hardly less
        return whole
    cuts = [((x0, y0, x, y1), (x, y0, x1, y1)) for x in _places(x0, x1)] + [
        ((x0, y0, x1, y), (x0, y, x1, y1)) for y in _places(y0, y1)
    ]
    pairs = [[_shrunk(inside, part) for part in cut] for cut in cuts]
    pairs = [pair for pair in pairs if all(pair)]
    if not pairs:
        return whole
    first, second = min(pairs, key=lambda pair: sum((x1 - x0) * (y1 - y0) for x0, y0, x1, y1 in pair))
    (cost_a, boxes_a), (cost_b, boxes_b) = _boxes(inside, first, samples), _boxes(inside, second, samples)
    return min(whole, (cost_a + cost_b, boxes_a + boxes_b), key=lambda choice: choice[0])


def _shrunk(inside, box):
    """The smallest box around what is inside within this one; None where nothing is."""
    x0, y0, x1, y1 = box
    part = inside[y0:y1, x0:x1]
    if not part.any():
        return None
    left, top, right, bottom = bounding_box(part)
    return x0 + left, y0 + top, x0 + right, y0 + bottom


def _places(low, high):
    return range(low + LEAST_SIDE, high - LEAST_SIDE + 1)[:: max(1, (high - low) // PLACES)]


def subpixel_mask(inside, reach, margin):
    """SUBPIXELS x SUBPIXELS values a pixel, open up to `reach` pixels around each pixel inside; `margin` pixels are added
    on each side."""
    mask = np.kron(np.pad(inside, margin), np.ones((SUBPIXELS, SUBPIXELS), bool))
    for axis in (0, 1):
        mask = _dilated(mask, math.ceil(reach * SUBPIXELS - 1e-6), axis)
    return mask


def _dilated(mask, by, axis):
    grown = mask.copy()
    for step in range(1, by + 1):
        ahead, behind = [slice(None)] * 2, [slice(None)] * 2
        ahead[axis], behind[axis] = slice(step, None), slice(None, -step)
        grown[tuple(ahead)] |= mask[tuple(behind)]
        grown[tuple(behind)] |= mask[tuple(ahead)]
    return grown


_number = itertools.count()


def write(folder, piece, reach, frame):
    """Writes the mask of a pass; returns what inside/camera.py asks for: a path, new every time since Cycles caches images
    by name, and the place in the frame (0..1, from the bottom left) that the image covers. frame: (height, width)."""
    margin = math.ceil(reach)
    mask = subpixel_mask(piece.inside, reach, margin)
    path = os.fspath(folder / f"mask_{next(_number)}.tif")
    spec = oiio.ImageSpec(mask.shape[1], mask.shape[0], 1, "uint8")
    spec.attribute("compression", "none")
    file = oiio.ImageOutput.create(path)
    if (
        not file
        or not file.open(path, spec)
        or not file.write_image(mask.astype(np.uint8)[..., None] * 255)
        or not file.close()
    ):
        raise DriverError(ExitCode.OUTPUT, f"{path}: {file.geterror() if file else oiio.geterror()}")
    height, width = frame
    x0, y0, x1, y1 = piece.box
    return {
        "path": path,
        "left": (x0 - margin) / width,
        "bottom": 1 - (y1 + margin) / height,
        "width": (x1 - x0 + 2 * margin) / width,
        "height": (y1 - y0 + 2 * margin) / height,
    }
