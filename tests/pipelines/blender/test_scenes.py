"""The scenes of the adaptive bench build quickly in both Blenders, and are the same each time."""

import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np

from pipelines.common import exr

RENDER = pathlib.Path(__file__).resolve().parents[3] / "samples" / "scenes" / "render.py"
BLENDER_3 = ["blender", "-b", "-Y", "--factory-startup", "--python-exit-code", "7", "-P", str(RENDER), "--"]
BLENDER_5 = [sys.executable, str(RENDER)]
BUILD_SECONDS = 60  # limit on a busy machine; usually a few


def render(blender, scene, folder, name):
    """The picture as an array (height, width, 3)."""
    target = pathlib.Path(folder) / f"{name}.exr"
    begin = time.monotonic()
    done = subprocess.run([*blender, scene, str(target), "--size=32x18", "--spp=2"], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    if time.monotonic() - begin > BUILD_SECONDS:
        raise AssertionError(f"{scene} took {time.monotonic() - begin:.0f} s")
    found = exr.read(target, lambda channel: channel.startswith("ViewLayer.Combined."))
    return np.stack([found[f"ViewLayer.Combined.{c}"] for c in "RGB"], axis=-1)


class Scenes(unittest.TestCase):
    def test_build_in_both_blenders_and_are_deterministic(self):
        for scene in ("gallery", "meadow", "fan"):
            with self.subTest(scene), tempfile.TemporaryDirectory() as folder:
                new = render(BLENDER_5, scene, folder, "new")
                old = render(BLENDER_3, scene, folder, "old")
                for picture in (new, old):
                    self.assertTrue(np.isfinite(picture).all())
                    self.assertGreater(picture.mean(), 0.01)
                if scene == "meadow":  # It is built from thousands of random numbers.
                    again = render(BLENDER_5, scene, folder, "again")
                    np.testing.assert_allclose(again, new, rtol=1e-4, atol=1e-5)  # Cycles rounds differently.


if __name__ == "__main__":
    unittest.main()
