"""Rounding of a sample map to counts that a renderer can take in few, coherent steps, and the cost of a sample."""

import dataclasses
from typing import Optional

import numpy as np

MAX_COUNT = 1 << 12  # Samples of one pixel in one pass
COST_BLUR = 4.0  # Standard deviation in pixels

# The lowest count over the mean one: a pass with a lower count costs more than its samples gain
# (docs/lab/2026-11-27-loop-seconds.md).
MIN_COUNT_OVER_MEAN = 0.25

# Standard deviation in pixels of how far a sample helps: half of the radius of `polyrecon samplemap`
# (docs/lab/2026-11-26-where-samples-go.md).
WINDOW = 3.5

# Standard deviation in pixels of the blur of a sample map. 8 leaves the least error, but 6 still finds a small spot
# (docs/lab/2026-11-27-loop-seconds.md).
COHERENCE = 6.0

MAX_COST_RATIO = 16  # Costs are kept within this factor of their mean.


@dataclasses.dataclass(frozen=True)
class Taken:
    """The samples and seconds of a half so far, sums over its parts. Arrays (height, width)."""

    counts: np.ndarray  # Samples of each pixel
    seconds: Optional[np.ndarray]  # Render time of these samples in any unit; None: the renderer does not measure it.

    def __add__(self, other):
        measured = self.seconds is not None and other.seconds is not None
        return Taken(self.counts + other.counts, self.seconds + other.seconds if measured else None)


def quantise(wanted, cost):
    """Counts that are 0 or powers of two, the lowest one about a quarter of their mean. They cost together what
    `wanted` (samples, any real numbers >= 0) does.

    The map is blurred first, so that neighbours mostly share a count: samples at the border between two counts are
    lost. Rounding to a power of two costs little, since sum v / n is flat around its minimum: a count that is off by a
    factor of sqrt 2 has 3 % more variance at most.

    cost: seconds of a sample in any unit, same shape. NaN in `wanted` counts as 0."""
    wanted = np.maximum(np.nan_to_num(wanted), 0)
    smooth = gaussian_blur(wanted, COHERENCE)
    budget = float((cost * wanted).sum())
    if budget <= 0:
        return np.zeros(wanted.shape, int)
    least = max(0.0, np.floor(np.log2(max(1.0, MIN_COUNT_OVER_MEAN * wanted.mean()))))
    low, high = 1e-3, 1e3  # Bracket of the factor that makes the costs equal; the cost grows with the factor.
    for _ in range(40):
        factor = np.sqrt(low * high)
        if (cost * _powers(smooth * factor, least)).sum() > budget:
            high = factor
        else:
            low = factor
    return _powers(smooth * low, least)


def _powers(values, least):
    """Nearest power of two by ratio; 0 for values below the lowest power, 2^least, divided by sqrt 2."""
    exponents = np.rint(np.log2(np.maximum(values, 1e-9)))
    return np.where(exponents < least, 0, 2.0 ** np.clip(exponents, 0, np.log2(MAX_COUNT))).astype(int)


def gaussian_blur(image, sigma):
    """Separable, with repeated edges."""
    radius = int(np.ceil(3 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        padded = np.pad(image, [(radius, radius) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        length = image.shape[axis]
        image = sum(k * np.take(padded, range(i, i + length), axis) for i, k in enumerate(kernel))
    return image


def weight_of_samples(variance, noise):
    """The effect of each pixel's noise on the result, in any unit: the weight of `polyrecon samplemap`, the geometric
    mean of the result's relative variance and the input's relative noise."""
    spread = [gaussian_blur(np.maximum(np.nan_to_num(values.astype(float)), 0), WINDOW) for values in (variance, noise)]
    return np.sqrt(spread[0] * spread[1])


def cost_of_samples(taken):
    """Seconds that a sample of each pixel costs, relative to the frame's mean; 1 everywhere where nothing was measured.

    A thread that had to wait in a pixel makes the measured seconds noisy. They are blurred, and kept within
    MAX_COST_RATIO times their mean before the blur and after it."""
    seconds, counts = taken.seconds, taken.counts
    if seconds is None or not np.isfinite(seconds).all() or seconds.sum() <= 0 or counts.sum() <= 0:
        return np.ones(counts.shape)
    seconds = np.minimum(seconds, MAX_COST_RATIO * counts * seconds.sum() / counts.sum())
    cost = gaussian_blur(seconds, COST_BLUR) / np.maximum(gaussian_blur(counts, COST_BLUR), 1e-9)
    return np.clip(cost / cost.mean(), 1 / MAX_COST_RATIO, MAX_COST_RATIO)
