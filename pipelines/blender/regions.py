"""Sample counts as rectangles with one count each, for a camera that has no mask.

The frame is cut in two again and again (a k-d tree), where that saves more samples than another pass costs."""

import numpy as np

from .masks import Pass

LEAST_SIDE = 8
PLACES = 15  # tried on each side of a rectangle


def plan(counts, overhead):
    """Passes for counts[y, x]. overhead: what starting one more pass costs, in samples of a pixel.

    A rectangle takes the mean of its pixels' counts, rounded to a power of two, in all of them, so it costs what they
    ask for. What it loses is precision: with counts n_i that minimise sum v_i / n_i, v_i ~ n_i^2, one count m for all
    gives sum n_i^2 / m in place of sum n_i; as many more samples would be needed to make up for it."""
    powers = (np.asarray(counts, float), np.asarray(counts, float) ** 2)
    tables = [np.pad(power.cumsum(0).cumsum(1), ((1, 0), (1, 0))) for power in powers]
    passes = []
    for x0, y0, x1, y1 in _cut((0, 0, counts.shape[1], counts.shape[0]), tables, overhead)[1]:
        mean = _sum(tables[0], (x0, y0, x1, y1)) / ((x1 - x0) * (y1 - y0))
        if mean >= 0.5:
            samples = int(2 ** max(0, round(np.log2(mean))))
            passes.append(Pass(0, samples, (x0, y0, x1, y1), np.ones((y1 - y0, x1 - x0), bool)))
    return passes


def _sum(table, box):
    x0, y0, x1, y1 = box
    return table[y1, x1] - table[y0, x1] - table[y1, x0] + table[y0, x0]


def _loss(tables, box):
    total, squares = (_sum(table, box) for table in tables)
    pixels = (box[2] - box[0]) * (box[3] - box[1])
    return squares * pixels / total - total if total > 0 else 0.0


def _cut(box, tables, overhead):
    """(loss and overhead, rectangles) of the cheaper one of: the box whole, the box cut at its best place."""
    whole = _loss(tables, box) + overhead, [box]
    if whole[0] <= 2 * overhead:
        return whole
    x0, y0, x1, y1 = box
    pairs = [((x0, y0, x, y1), (x, y0, x1, y1)) for x in _places(x0, x1)]
    pairs += [((x0, y0, x1, y), (x0, y, x1, y1)) for y in _places(y0, y1)]
    if not pairs:
        return whole
    parts = min(pairs, key=lambda pair: sum(_loss(tables, part) for part in pair))
    (loss_a, boxes_a), (loss_b, boxes_b) = (_cut(part, tables, overhead) for part in parts)
    return min(whole, (loss_a + loss_b, boxes_a + boxes_b), key=lambda choice: choice[0])


def _places(low, high):
    inner = range(low + LEAST_SIDE, high - LEAST_SIDE + 1)
    return inner[:: max(1, len(inner) // PLACES)]
