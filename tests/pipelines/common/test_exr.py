import os
import tempfile
import unittest
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

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
        with self.assertRaisesRegex(DriverError, "gone.exr: No such file") as caught:
            exr.read(self.folder / "gone.exr")
        self.assertEqual(caught.exception.code, ExitCode.MISSING)
        with self.assertRaisesRegex(DriverError, "such.exr") as caught:
            exr.write(broken / "such.exr", {"R": np.zeros((1, 1))})
        self.assertEqual(caught.exception.code, ExitCode.OUTPUT)

    def test_a_folder_that_is_not_utf8(self):
        path = Path(os.fsdecode(os.fsencode(self.folder) + b"/b\xe9")) / "a.exr"
        path.parent.mkdir()
        exr.write(path, {"R": np.full((2, 3), 7.0)})
        np.testing.assert_array_equal(exr.read(path)["R"], np.full((2, 3), 7))
        path.write_bytes(path.read_bytes()[:-9])
        with self.assertRaisesRegex(DriverError, "a.exr: ") as caught:
            exr.read(path)
        self.assertEqual(caught.exception.code, ExitCode.BAD_INPUT)

    def test_no_other_decoder_and_no_pipe_is_opened(self):
        """OpenImageIO tries all its formats on a file, whatever its name."""
        picture = oiio.ImageOutput.create("tiff")
        picture.open(os.fspath(self.folder / "a.tif"), oiio.ImageSpec(2, 2, 1, "uint8"))
        picture.write_image(np.zeros((2, 2, 1), np.uint8))
        picture.close()
        (self.folder / "a.tif").rename(self.folder / "tiff.exr")
        (self.folder / "folder.exr").mkdir()
        os.mkfifo(self.folder / "pipe.exr")
        for name, line in (("tiff", "not an EXR"), ("folder", "."), ("pipe", "not a regular file")):
            for function in (exr.read, exr.metadata):
                with self.assertRaisesRegex(DriverError, f"{name}.exr: .*{line}") as caught:
                    function(self.folder / f"{name}.exr")
                self.assertEqual(caught.exception.code, ExitCode.BAD_INPUT)

    def test_names_of_channels_that_are_not_utf8(self):
        exr.write(self.folder / "a.exr", {"Lay.R": np.zeros((2, 2))}, compression="none")
        content = (self.folder / "a.exr").read_bytes()
        (self.folder / "a.exr").write_bytes(content.replace(b"Lay.R", b"L\xe9y.R"))
        with self.assertRaisesRegex(DriverError, "a.exr: a name in it is not UTF-8") as caught:
            exr.read(self.folder / "a.exr")
        self.assertEqual(caught.exception.code, ExitCode.BAD_INPUT)


if __name__ == "__main__":
    unittest.main()
