"""A shot of small frames that differ from each other, from a sample."""

import os
import pathlib

from pipelines.common import exr

SAMPLES = pathlib.Path(os.environ["POLYRECON_SAMPLES"])


def make_shot(folder, frames, height=36, width=64):
    """Writes folder/shot.####.exr: crops of a render that move from frame to frame."""
    channels = exr.read(SAMPLES / "study_small_0.exr")
    for k, frame in enumerate(frames):
        x, y = 2 * k % (160 - width), k % (90 - height)
        window = {name: pixels[y : y + height, x : x + width] for name, pixels in channels.items()}
        exr.write(pathlib.Path(folder) / f"shot.{frame:04d}.exr", window)
