"""Steps between neighbouring pixels that a picture has and its reference does not: blocks, dots, jagged rims, grain."""

import numpy as np

BLUR = 0.5  # standard deviation of the Gaussian on the reference, pixels: its own noise and aliasing count less
AROUND = 5  # side of the square in which the reference's largest step is looked for, pixels
TIMES = 1.5  # a step may be so many times that step,
VISIBLE = 0.04  # and this much above it, in display values


def display_values(radiance):
    """The sRGB curve of radiance 0 to 1, as a monitor shows it."""
    x = np.clip(radiance, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def blur(image):
    """A Gaussian of BLUR pixels along rows and columns; the border is mirrored."""
    radius = round(4 * BLUR)
    weights = np.exp(-0.5 * (np.arange(-radius, radius + 1) / BLUR) ** 2)
    weights /= weights.sum()
    for axis in (0, 1):
        padding = [(0, 0)] * image.ndim
        padding[axis] = (radius, radius)
        padded = np.pad(image, padding, "symmetric")
        image = np.lib.stride_tricks.sliding_window_view(padded, len(weights), axis) @ weights
    return image


def largest_around(values):
    """The largest value of the AROUND x AROUND pixels around each one."""
    padded = np.pad(values, AROUND // 2, "edge")
    return np.lib.stride_tricks.sliding_window_view(padded, (AROUND, AROUND)).max((-1, -2))


def steps(image, axis):
    """The difference of each pixel to the next one along the axis; of three colours the largest."""
    return np.abs(np.diff(image, axis=axis)).max(-1)


def false_edges(image, reference):
    """False edges per 10,000 pixels. image, reference: linear radiance, (height, width, 3)."""
    shown, known = display_values(image), display_values(blur(reference))
    count = sum(
        np.count_nonzero(steps(shown, axis) > TIMES * largest_around(steps(known, axis)) + VISIBLE) for axis in (0, 1)
    )
    return 1e4 * count / (image.shape[0] * image.shape[1])
