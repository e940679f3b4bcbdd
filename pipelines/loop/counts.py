"""From a sample map to integer counts that a renderer can take in few, coherent passes."""

import numpy as np

MOST = 1 << 12  # samples of one pixel in one pass
COST_BLUR = 4.0  # pixels, standard deviation
LEAST_OVER_MEAN = 0.25  # the lowest count: below it a pass costs more than its samples are worth
WINDOW = 3.5  # pixels, standard deviation: how far a sample helps (SampleMapParams::radius / 2)
COHERENCE = 6.0  # pixels, standard deviation of the blur: docs/lab/2026-11-27-loop-seconds.md


def quantise(wanted, cost):
    """Counts that are 0 or powers of two, from about a quarter of their mean on, and cost together what `wanted` (samples, any
    real numbers >= 0) does.

    The map is smoothed first, so that neighbours mostly share a count: borders between counts cost samples. Rounding to a
    power of two costs little: sum v / n is flat around its minimum (3 % more variance at most, a factor of sqrt 2 off).
    cost: seconds of a sample, same shape, any unit."""
    wanted = np.maximum(np.nan_to_num(wanted), 0)
    smooth = gaussian_blur(wanted, COHERENCE)
    budget = float((cost * wanted).sum())
    if budget <= 0:
        return np.zeros(wanted.shape, int)
    least = max(0.0, np.floor(np.log2(max(1.0, LEAST_OVER_MEAN * wanted.mean()))))
    low, high = 1e-3, 1e3  # of the factor that makes the costs equal; the cost grows with it
    for _ in range(40):
        factor = np.sqrt(low * high)
        if (cost * _powers(smooth * factor, least)).sum() > budget:
            high = factor
        else:
            low = factor
    return _powers(smooth * low, least)


def _powers(values, least):
    """Nearest power of two by ratio, 0 below 1 / sqrt 2 of the lowest one, 2^least."""
    exponents = np.rint(np.log2(np.maximum(values, 1e-9)))
    return np.where(exponents < least, 0, 2.0 ** np.clip(exponents, 0, np.log2(MOST))).astype(int)


def gaussian_blur(image, sigma):
    """Separable, edges repeated."""
    radius = int(np.ceil(3 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        padded = np.pad(image, [(radius, radius) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        length = image.shape[axis]
        image = sum(k * np.take(padded, range(i, i + length), axis) for i, k in enumerate(kernel))
    return image


def weight_of_samples(variance, noise):
    """What the noise of each pixel does to the result, in any unit: the geometric mean that sample maps go by
    (maps/sample_map.h), of a result's relative variance and its input's relative noise."""
    spread = [gaussian_blur(np.maximum(np.nan_to_num(values.astype(float)), 0), WINDOW) for values in (variance, noise)]
    return np.sqrt(spread[0] * spread[1])


def cost_of_samples(seconds, counts):
    """Seconds that a sample of each pixel costs, relative to the frame's mean, from what was measured: noisy (a thread that
    had to wait in a pixel counts there), so smoothed and kept within a factor of 16 of the mean, before and after.
    seconds, counts: sums over passes; None or nothing measured: 1 everywhere."""
    if seconds is None or not np.isfinite(seconds).all() or seconds.sum() <= 0 or counts.sum() <= 0:
        return np.ones(counts.shape)
    seconds = np.minimum(seconds, 16 * counts * seconds.sum() / counts.sum())
    cost = gaussian_blur(seconds, COST_BLUR) / np.maximum(gaussian_blur(counts, COST_BLUR), 1e-9)
    return np.clip(cost / cost.mean(), 1 / 16, 16)
