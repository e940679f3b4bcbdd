"""Pixels from subpixels: mean, variance of the mean, two halves.

POV-Ray's noise is the same in every run, so the samples of a pixel are its subpixels, a grid of n x n in one render.
"""

import dataclasses

import numpy as np


@dataclasses.dataclass
class Estimate:
    """Pixels from n x n subpixels: arrays (height, width, channels)."""

    mean: np.ndarray
    variance: np.ndarray  # of the mean; 0 if there is one subpixel
    a: np.ndarray  # mean of the white fields of the chessboard of subpixels
    b: np.ndarray  # mean of the black fields

    def crop(self, rows, columns):
        return Estimate(*(planes[rows, columns] for planes in (self.mean, self.variance, self.a, self.b)))

    def paste(self, rows, columns, part):
        for name in ("mean", "variance", "a", "b"):
            getattr(self, name)[rows, columns] = getattr(part, name)


def blocks(image, n):
    """(n * height, n * width, channels) -> (height, width, n, n, channels), a view."""
    height, width, channels = image.shape[0] // n, image.shape[1] // n, image.shape[2]
    return image.reshape(height, n, width, n, channels).swapaxes(1, 2)


def estimate(image, n):
    """The Estimate of an image of subpixels.

    The grid is a stratified sample. A linear change across the pixel adds hardly any error to the mean, but it would
    add all of its variance to the sample variance of the subpixels. Therefore the variance of a subpixel comes from the
    mixed differences of four neighbours, E (y_00 - y_01 - y_10 + y_11)^2 / 4, which are 0 for linear changes (Cochran,
    Sampling Techniques, 8.11: systematic sampling in two dimensions). The halves are the two colours of a chessboard:
    each covers the whole pixel and has the same number of subpixels in every row and column."""
    subpixels = np.asarray(blocks(image, n), np.float64)
    mean = subpixels.mean((2, 3))
    if n == 1:
        return Estimate(mean, np.zeros_like(mean), mean, mean)
    rows = subpixels[:, :, 1:] - subpixels[:, :, :-1]
    variance = ((rows[:, :, :, 1:] - rows[:, :, :, :-1]) ** 2).mean((2, 3)) / (4 * n * n)
    white = np.add.outer(np.arange(n), np.arange(n)) % 2 == 0
    halves = (subpixels[:, :, field].mean(2) for field in (white, ~white))
    return Estimate(mean, variance, *halves)


def join(first, count, second, more):
    """Joins two estimates of the same pixels from disjoint samples, `count` and `more` of each pixel."""
    total = count + more
    mean, a, b = ((count * getattr(first, k) + more * getattr(second, k)) / total for k in ("mean", "a", "b"))
    variance = (count**2 * first.variance + more**2 * second.variance) / total**2
    return Estimate(mean, variance, a, b)
