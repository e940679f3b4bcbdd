"""Crops of a frame, the smallest things that POV-Ray renders. It parses the scene again for each of them."""

import dataclasses

import numpy as np

from ..common import rectangles


@dataclasses.dataclass(frozen=True)
class Crop:
    """Pixels x0 <= x < x1, y0 <= y < y1 of the frame, row 0 at the top."""

    x0: int
    y0: int
    x1: int
    y1: int

    @property
    def width(self):
        return self.x1 - self.x0

    @property
    def height(self):
        return self.y1 - self.y0


def cover(grid, overhead):
    """Disjoint crops that hold every pixel with grid[y, x] > 0, each with the largest grid of its pixels: [(Crop, n)].

    The cost of a crop is one per subpixel (n * n a pixel) and `overhead`."""
    grid = np.asarray(grid)
    boxes = rectangles.cover(grid, lambda n: np.square(n, dtype=float), overhead)
    return [(Crop(x0, y0, x1, y1), int(grid[y0:y1, x0:x1].max())) for x0, y0, x1, y1 in boxes]
