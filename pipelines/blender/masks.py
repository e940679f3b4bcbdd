"""Images of the masks of passes, for the camera of inside/camera.py."""

import itertools
import math
import os

import numpy as np
import OpenImageIO as oiio

from ..common.errors import DriverError, ExitCode

SUBPIXELS = 4


def subpixel_mask(inside, overhang, margin):
    """A mask with SUBPIXELS x SUBPIXELS values a pixel, which is open up to `overhang` pixels around each pixel inside.
    It has `margin` more pixels on each side than `inside`."""
    mask = np.kron(np.pad(inside, margin), np.ones((SUBPIXELS, SUBPIXELS), bool))
    for axis in (0, 1):
        mask = _dilated(mask, math.ceil(overhang * SUBPIXELS - 1e-6), axis)
    return mask


def _dilated(mask, by, axis):
    grown = mask.copy()
    for step in range(1, by + 1):
        ahead, behind = [slice(None)] * 2, [slice(None)] * 2
        ahead[axis], behind[axis] = slice(step, None), slice(None, -step)
        grown[tuple(ahead)] |= mask[tuple(behind)]
        grown[tuple(behind)] |= mask[tuple(ahead)]
    return grown


_number = itertools.count()


def write(folder, render_pass, overhang, frame):
    """Writes the mask of a pass; returns the argument of inside/camera.py: MaskCamera.use.

    overhang: pixels by which samples may fall outside of their pixel. frame: (height, width). Each mask has a new name,
    because Cycles caches images by name."""
    margin = math.ceil(overhang)
    mask = subpixel_mask(render_pass.inside, overhang, margin)
    path = os.fspath(folder / f"mask_{next(_number)}.tif")
    spec = oiio.ImageSpec(mask.shape[1], mask.shape[0], 1, "uint8")
    spec.attribute("compression", "none")
    file = oiio.ImageOutput.create("tiff")
    if (
        not file
        or not file.open(os.fsencode(path), spec)
        or not file.write_image(mask.astype(np.uint8)[..., None] * 255)
        or not file.close()
    ):
        raise DriverError(ExitCode.OUTPUT, f"{path}: {file.geterror() if file else oiio.geterror()}")
    height, width = frame
    x0, y0, x1, y1 = render_pass.box
    return {
        "path": path,
        "left": (x0 - margin) / width,
        "bottom": 1 - (y1 + margin) / height,
        "width": (x1 - x0 + 2 * margin) / width,
        "height": (y1 - y0 + 2 * margin) / height,
    }
