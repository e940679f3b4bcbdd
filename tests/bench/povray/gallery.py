"""Makes the picture of docs/guide/povray.md: a row for each scene, with one sample per pixel and the feature passes."""

import numpy as np
import OpenImageIO as oiio

from pipelines.common.errors import DriverError, ExitCode
from pipelines.povray import passes
from pipelines.povray.scene import Scene

WIDTH, HEIGHT, GAP = 160, 120, 4  # pixels of one picture, and between rows
COLUMNS = ("Combined", "Denoising Albedo", "Visibility", "Denoising Normal", "Denoising Depth")


def write(target, scenes):
    """Writes the picture of these scene files. The place of a pass that a scene does not have stays white."""
    rows = [_row(path) for path in scenes]
    between = np.ones((GAP, *rows[0].shape[1:]))
    pixels = np.concatenate([part for row in rows for part in (row, between)][:-1]).astype(np.float32)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8")
    spec.attribute("compression", "jpeg:90")
    file = oiio.ImageOutput.create(str(target))
    if not file or not file.open(str(target), spec) or not file.write_image(pixels) or not file.close():
        raise DriverError(ExitCode.OUTPUT, f"{target}: {file.geterror() if file else oiio.geterror()}")


def _row(path):
    with Scene(path, [f"+W{WIDTH}", f"+H{HEIGHT}"]) as scene:
        choice = passes.choose_passes(scene)
        images = {name: layer.mean for name, layer in passes.render_features(scene, choice, 1).items()}
        images["Combined"] = scene.render(1)
    white = np.ones((HEIGHT, WIDTH, 3))
    return np.concatenate([_shown(name, images[name]) if name in images else white for name in COLUMNS], axis=1)


def _shown(name, image):
    if name == "Denoising Normal":
        image = 0.5 + 0.5 * image
    elif name == "Denoising Depth":
        image = image / (image + np.median(image))
    else:
        linear = np.clip(image, 0, 1)
        image = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)  # sRGB
    return np.broadcast_to(image, (HEIGHT, WIDTH, 3))
