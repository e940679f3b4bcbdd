"""Arrays as they come in and go out."""

from __future__ import annotations

import dataclasses
import os
from typing import Any

import numpy as np
import numpy.typing as npt

from ._library import USAGE, Error


class Images(dict):  # type: ignore[type-arg]
    """The passes of a frame by name: arrays of (height, width, channels), or (height, width) where there is one.

    Names: `beauty`, `albedo`, `normal`, `depth`, `visibility`, `prior`, each also with the ending ` variance` (of the
    mean), ` A` and ` B` (means over two independent halves of the samples); `alpha`, `sample-count`, and `aov NAME`.
    report: what the file said of them: roles, notes.
    """

    report: dict[str, Any]

    def __init__(self, *arguments: Any, report: dict[str, Any] | None = None, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.report = report or {}


@dataclasses.dataclass
class Result:
    """A denoised frame. All arrays are float32."""

    image: np.ndarray
    """(height, width, 3): linear radiance."""
    relmse: np.ndarray
    """(height, width): estimated squared error over squared brightness, mean over RGB of mse / (image^2 + 0.01)."""
    relvariance: np.ndarray
    """(height, width): the part of relmse that is noise; the rest is bias."""
    relnoise: np.ndarray
    """(height, width): noise variance of the input over squared brightness."""
    mse: np.ndarray
    """(height, width, 3): estimated squared error, radiance squared."""
    order: np.ndarray
    """(height, width): mean order of the polynomials that cover a pixel."""
    aovs: dict[str, np.ndarray]
    """Further layers by name, (height, width, 3)."""
    alpha: np.ndarray | None
    """(height, width), 0 to 1; None unless it was to be denoised."""
    samples: np.ndarray | None
    """(height, width): extra samples of each pixel; None without `budget` or `target`."""
    report: dict[str, Any]
    """The steps taken, with their counts and estimates: docs/reference/report.md."""


def as_image(name: str, array: npt.ArrayLike) -> np.ndarray:
    """The array with three dimensions and a type that the library reads; copied only where it must be."""
    if array is None or isinstance(array, (str, bytes, os.PathLike)):
        given = "is None" if array is None else f"is the text {os.fsdecode(array)!r}"
        raise Error(f"image '{name}': {given}, an array is needed; polyrecon.read makes arrays of a file", USAGE)
    if isinstance(array, np.ma.MaskedArray):
        raise Error(f"image '{name}': has a mask, which is not used; give its .filled(nan) or its .data", USAGE)
    try:
        image = np.asarray(array)
    except ValueError as error:  # lists of different lengths
        raise Error(f"image '{name}': {error}", USAGE) from None
    if image.ndim == 2:
        image = image[:, :, np.newaxis]
    if image.ndim != 3:
        raise Error(f"image '{name}': has {image.ndim} dimensions, (height, width, channels) are needed", USAGE)
    if name == "sample-count" and np.issubdtype(image.dtype, np.integer):
        image = image.astype(np.float32)
    if not np.issubdtype(image.dtype, np.floating):
        raise Error(f"image '{name}': has samples of type {image.dtype}; float16, float32 or float64 is needed", USAGE)
    if image.dtype not in (np.float16, np.float32):
        image = image.astype(np.float32)
    # The library takes strides of 0 for "no padding".
    if any(stride == 0 and size > 1 for stride, size in zip(image.strides, image.shape)):
        image = np.ascontiguousarray(image)
    return image


def without_channel(image: np.ndarray) -> np.ndarray:
    return image[:, :, 0] if image.shape[2] == 1 else image
