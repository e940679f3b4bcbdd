import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

from pipelines.common import exr
from pipelines.common.errors import DriverError, ExitCode

SAMPLES = Path(os.environ["POLYRECON_SAMPLES"])


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_what_is_written_comes_back(self):
        pixels = np.arange(12, dtype=np.float32).reshape(3, 4)
        channels = {"L.Combined.R": pixels, "L.Sample Count.X": pixels * -1e30}
        path = self.folder / "ä b#.exr"
        exr.write(path, channels, {"frame": 3})
        back = exr.read(path)
        self.assertEqual(list(back), list(channels))
        for name in channels:
            np.testing.assert_array_equal(back[name], channels[name])
        self.assertEqual(exr.metadata(path)["frame"], 3)
        self.assertEqual(os.listdir(self.folder), ["ä b#.exr"])

    def test_all_parts_are_read_and_names_chosen(self):
        path = SAMPLES / "study_small_0.exr"
        channels = exr.read(path, lambda name: ".Combined." in name or "Normal" in name)
        self.assertLessEqual({"ViewLayer.Combined.R", "ViewLayer.Denoising Normal.X"}, set(channels))
        self.assertNotIn("ViewLayer.Denoising Albedo.R", channels)
        self.assertEqual({c.shape for c in channels.values()}, {(90, 160)})

    def test_bad_input_and_output_are_named(self):
        broken = self.folder / "broken.exr"
        broken.write_bytes(b"no image")
        with self.assertRaisesRegex(DriverError, "broken.exr") as caught:
            exr.read(broken)
        self.assertEqual(caught.exception.code, ExitCode.BAD_INPUT)
        with self.assertRaisesRegex(DriverError, "such.exr") as caught:
            exr.write(self.folder / "no" / "such.exr", {"R": np.zeros((1, 1))})
        self.assertEqual(caught.exception.code, ExitCode.OUTPUT)


if __name__ == "__main__":
    unittest.main()
