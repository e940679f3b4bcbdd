"""The render passes for the counts of a part, for renderers that render masks or rectangles with one count each.

Fixed costs are in samples of a pixel: how many samples take as long."""

import dataclasses

import numpy as np

from ..common import rectangles


@dataclasses.dataclass
class Pass:
    skip: int  # samples of the sequence before this pass's
    samples: int
    box: tuple  # x0, y0, x1, y1 in pixels from the top left, end excluded
    inside: np.ndarray  # bool, of the box's shape: pixels whose samples count


def masked_passes(counts, overhead, pixel_overhead):
    """Passes for counts[y, x], each in boxes around its pixels. overhead: the fixed cost of a pass. pixel_overhead:
    that of each pixel of its box, in the mask or not.

    The passes are nested: all pixels with samples take the lowest count. Pixels with a higher count continue in the
    sequence up to the next count, and so on. So a border between two counts has a rim on one side, with as many samples
    as the counts differ by. With a pass for each count it would have a rim on either side, with all samples."""
    passes, done = [], 0
    for count in np.unique(counts[counts > 0]).astype(int):
        inside, samples = counts >= count, int(count) - done
        for box in rectangles.cover(inside, lambda _, samples=samples: samples + pixel_overhead, overhead):
            x0, y0, x1, y1 = box
            passes.append(Pass(done, samples, box, inside[y0:y1, x0:x1]))
        done = int(count)
    return passes


def rectangular_passes(counts, overhead):
    """Passes for counts[y, x] without masks: rectangles that take the mean of their counts, rounded to a power of two,
    in every pixel. overhead: the fixed cost of a pass. Where all means are too small for a sample, the rows that want
    most take one."""
    passes = []
    for x0, y0, x1, y1 in rectangles.level(counts, overhead):
        mean = counts[y0:y1, x0:x1].mean()
        if mean >= 0.5:
            samples = int(2 ** max(0, round(np.log2(mean))))
            passes.append(Pass(0, samples, (x0, y0, x1, y1), np.ones((y1 - y0, x1 - x0), bool)))
    if not passes and counts.any():
        width = counts.shape[1]
        rows = max(1, int(counts.sum()) // width)
        y0 = rectangles.first_of_fullest_rows(counts, rows)
        passes.append(Pass(0, 1, (0, y0, width, y0 + rows), np.ones((rows, width), bool)))
    return passes
