"""Rectangles that cover the pixels that want more samples: POV-Ray renders nothing smaller than a crop, and parses the
scene anew for each."""

import numpy as np

from .scene import Crop


def cover(grid, overhead):
    """Disjoint crops that hold every pixel with grid[y, x] > 0, each with the grid that its neediest pixel asks for:
    [(Crop, n)]. Splits by vertical and horizontal lines as long as that lowers the cost, one per subpixel (n * n a
    pixel) and `overhead` per crop."""
    found = _tight(np.asarray(grid))
    return _split(grid, found, overhead) if found else []


def _split(grid, crop, overhead):
    part = grid[crop.y0 : crop.y1, crop.x0 : crop.x1]
    best = None
    for axis, image in ((0, part), (1, part.T)):
        costs = _prefix_costs(image)[:-1] + _prefix_costs(image[::-1])[::-1][1:]
        if costs.size and (best is None or costs.min() < best[0]):
            best = (costs.min(), axis, int(costs.argmin()) + 1)
    whole = part.size * int(part.max()) ** 2
    if best is None or best[0] + overhead >= whole:
        return [(crop, int(part.max()))]
    _, axis, at = best
    crops = []
    for piece, x, y in (
        ((part[:at], 0, 0), (part[at:], 0, at)) if axis == 0 else ((part[:, :at], 0, 0), (part[:, at:], at, 0))
    ):
        inner = _tight(piece, crop.x0 + x, crop.y0 + y)
        crops += _split(grid, inner, overhead) if inner else []
    return crops


def _prefix_costs(image):
    """Subpixels of the smallest crop around the first 1, 2, ... rows, each row's columns counted whole between the first
    and the last that are wanted."""
    wanted = image > 0
    rows = np.arange(len(image))
    some = wanted.any(1)
    width = image.shape[1]
    left = np.minimum.accumulate(np.where(some, wanted.argmax(1), width))
    right = np.maximum.accumulate(np.where(some, width - wanted[:, ::-1].argmax(1), 0))
    last = np.maximum.accumulate(np.where(some, rows, -1))
    first = int(some.argmax()) if some.any() else len(image)
    most = np.maximum.accumulate(image.max(1)).astype(np.float64)
    return np.where(last >= 0, (last - first + 1) * np.maximum(right - left, 0) * most**2, 0.0)


def _tight(grid, x=0, y=0):
    """The smallest crop around what is wanted, moved by (x, y); None where nothing is."""
    rows, columns = np.flatnonzero(grid.any(1)), np.flatnonzero(grid.any(0))
    if not rows.size:
        return None
    return Crop(x + int(columns[0]), y + int(rows[0]), x + int(columns[-1]) + 1, y + int(rows[-1]) + 1)
