"""Divides a frame into rectangles for a renderer that has a fixed cost for each of them.

A rectangle is cut in two where the two parts cost least, and each part is cut again, and so on (a k-d tree). A cut is
kept if all rectangles that came of it cost less than the uncut one. Rectangles are (x0, y0, x1, y1) in pixels from the
top left, with the end excluded."""

import numpy as np

# No part is narrower than this share of the rectangle that is cut. Otherwise noise in the values is shaved off row by
# row, and a tree of hundreds of levels gains nothing.
NARROWEST = 1 / 12


def bounding_box(inside, box=None):
    """The smallest rectangle around all pixels inside, or around those within `box`; None if there are none."""
    x0, y0, x1, y1 = box or (0, 0, inside.shape[1], inside.shape[0])
    part = inside[y0:y1, x0:x1]
    rows, columns = np.flatnonzero(part.any(1)), np.flatnonzero(part.any(0))
    if not rows.size:
        return None
    return x0 + int(columns[0]), y0 + int(rows[0]), x0 + int(columns[-1]) + 1, y0 + int(rows[-1]) + 1


def first_of_fullest_rows(values, rows):
    """The first of so many adjacent rows whose values have the largest sum."""
    sums = np.concatenate([[0], values.sum(1).cumsum()])
    return int((sums[rows:] - sums[:-rows]).argmax())


def area(box):
    x0, y0, x1, y1 = box
    return (x1 - x0) * (y1 - y0)


def cover(values, price, overhead):
    """Disjoint rectangles around all pixels with values[y, x] > 0, each the bounding box of those that it holds.

    A rectangle costs `overhead`, and price(its largest value) for each pixel; price takes a number or an array."""
    values = np.asarray(values)
    inside = values > 0
    whole = bounding_box(inside)
    if whole is None:
        return []

    def cost(box):
        x0, y0, x1, y1 = box
        return area(box) * price(values[y0:y1, x0:x1].max())

    def costs_of_cuts(box, axis):
        x0, y0, x1, y1 = box
        rows = values[y0:y1, x0:x1] if axis else values[y0:y1, x0:x1].T
        return _costs_of_first_rows(rows, price)[:-1] + _costs_of_first_rows(rows[::-1], price)[::-1][1:]

    return _divide(whole, cost, costs_of_cuts, lambda box: bounding_box(inside, box), overhead)


def _costs_of_first_rows(values, price):
    """The costs of the bounding boxes of the first 1, 2, ... rows."""
    inside = values > 0
    occupied = inside.any(1)
    width = values.shape[1]
    left = np.minimum.accumulate(np.where(occupied, inside.argmax(1), width))
    right = np.maximum.accumulate(np.where(occupied, width - inside[:, ::-1].argmax(1), 0))
    last = np.maximum.accumulate(np.where(occupied, np.arange(len(values)), -1))
    first = int(occupied.argmax())
    largest = np.maximum.accumulate(values.max(1))
    return np.where(last >= 0, (last - first + 1) * np.maximum(right - left, 0) * price(largest), 0.0)


def level(counts, overhead):
    """Rectangles that fill the frame, each to be rendered with the mean of its pixels' counts.

    The mean of a rectangle takes as many samples as its counts, but it loses precision: with counts n_i that minimise
    sum v_i / n_i, where v_i ~ n_i^2, one count m for all gives sum n_i^2 / m in place of sum n_i. The difference, in
    samples, is the cost of a rectangle, in addition to `overhead`."""
    counts = np.asarray(counts, float)
    tables = [np.pad(power.cumsum(0).cumsum(1), ((1, 0), (1, 0))) for power in (counts, counts**2)]

    def cost(box):
        x0, y0, x1, y1 = box
        total, squares = (table[y1, x1] - table[y0, x1] - table[y1, x0] + table[y0, x0] for table in tables)
        return float(_loss(total, squares, area(box)))

    def costs_of_cuts(box, axis):
        x0, y0, x1, y1 = box
        if axis:
            columns = [table[y0 : y1 + 1, x1] - table[y0 : y1 + 1, x0] for table in tables]
        else:
            columns = [table[y1, x0 : x1 + 1] - table[y0, x0 : x1 + 1] for table in tables]
        total, squares = (column - column[0] for column in columns)
        pixels = np.arange(len(total)) * (x1 - x0 if axis else y1 - y0)
        both = _loss(total, squares, pixels) + _loss(total[-1] - total, squares[-1] - squares, pixels[-1] - pixels)
        return both[1:-1]

    return _divide((0, 0, counts.shape[1], counts.shape[0]), cost, costs_of_cuts, lambda box: box, overhead)


def _loss(total, squares, pixels):
    return np.where(total > 0, squares * pixels / np.where(total > 0, total, 1) - total, 0.0)


def _divide(box, cost, costs_of_cuts, shrink, overhead):
    """The rectangles of a box.

    costs_of_cuts(box, axis): what both parts cost after a cut behind column (axis 0) or row (axis 1) 0, 1, ...
    shrink(part): the part without the pixels that need not be in a rectangle."""

    def divide(box):
        """(cost with overheads, rectangles)"""
        uncut = cost(box) + overhead, [box]
        parts = _best_cut(box, costs_of_cuts) if uncut[0] > 2 * overhead else None
        if not parts:
            return uncut
        (cost_a, boxes_a), (cost_b, boxes_b) = (divide(shrink(part)) for part in parts)
        return min(uncut, (cost_a + cost_b, boxes_a + boxes_b), key=lambda choice: choice[0])

    return divide(box)[1]


def _best_cut(box, costs_of_cuts):
    """The two parts that cost least; None if no cut is possible."""
    x0, y0, x1, y1 = box
    best, parts = np.inf, None
    for axis, length in enumerate((x1 - x0, y1 - y0)):
        narrowest = max(1, int(length * NARROWEST))
        costs = costs_of_cuts(box, axis)[narrowest - 1 : length - narrowest]
        if costs.size and costs.min() < best:
            best = costs.min()
            # The middle one of the places that are as good: the parts are then similar in size and the tree stays flat.
            equal = np.flatnonzero(costs == best)
            at = narrowest + int(equal[len(equal) // 2])
            parts = (
                ((x0, y0, x1, y0 + at), (x0, y0 + at, x1, y1))
                if axis
                else ((x0, y0, x0 + at, y1), (x0 + at, y0, x1, y1))
            )
    return parts
