"""What a user gets: endings, files that exist, folders, types and compression of the picture."""

import os
import tempfile
import unittest
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from pipelines.common import exr, outputs
from pipelines.common.errors import DriverError, ExitCode


class Outputs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def refused(self, code, text, check, *arguments):
        with self.assertRaisesRegex(DriverError, text) as caught:
            check(*arguments)
        self.assertEqual(caught.exception.code, code)

    def test_the_ending_is_that_of_the_format(self):
        outputs.check_ending("a.EXR", ".exr")
        for name in ("a.png", "a.tif", "a", "a.exr.png"):
            self.refused(ExitCode.USAGE, "must end in .exr; `polyrecon preview`", outputs.check_ending, name, ".exr")

    def test_what_exists_is_not_overwritten_unasked(self):
        paths = [self.folder / name for name in ("a.exr", "b.exr", "c.exr")]
        outputs.check_new(paths, False)
        paths[1].touch()
        self.refused(ExitCode.USAGE, "b.exr: exists already; add --overwrite", outputs.check_new, paths, False)
        paths[2].symlink_to("nowhere")
        text = "b.exr: exists already, and 1 more outputs exist already; add --overwrite"
        self.refused(ExitCode.USAGE, text, outputs.check_new, paths, False)
        outputs.check_new(paths, True)

    def test_the_nearest_folder_is_looked_at(self):
        outputs.check_writable([self.folder / "new" / "er" / "a.exr"])
        self.assertEqual(os.listdir(self.folder), [])
        (self.folder / "file").touch()
        self.refused(ExitCode.OUTPUT, "file: is not a folder", outputs.check_writable, [self.folder / "file" / "a.exr"])
        if os.geteuid():
            (self.folder / "closed").mkdir(mode=0o500)
            closed = [self.folder / "closed" / "a.exr"]
            self.refused(ExitCode.OUTPUT, "closed: no permission", outputs.check_writable, closed)

    def test_the_picture_is_lean(self):
        random = np.random.default_rng(1)
        names = ["V.Combined.R", "V.Combined.A", "V.Depth.Z", "V.CryptoObject00.R", "V.Combined Variance.R"]
        channels = {name: random.random((64, 64), np.float32) * 1e5 for name in names}
        exr.write(self.folder / "all.exr", channels, {"Camera": "c"}, "none")

        def type_of(name):
            return None if "Variance" in name else "half" if outputs.is_colour(name) else "float"

        for compression, written in (("zip", "zip"), ("piz", "piz"), ("b44", "b44"), ("dwab", "zip"), ("pxr24", "zip")):
            target = self.folder / "new" / f"{compression}.exr"
            words = outputs.encoding(compression, 45)
            note = outputs.deliver(self.folder / "all.exr", target, type_of, words, {"polyrecon/loop": "digest"})
            spec = oiio.ImageInput.open(str(target)).spec()
            self.assertEqual(spec.getattribute("compression"), written)
            self.assertEqual(f"zip, as {compression} would change V." in note, written != compression)
            self.assertEqual(sorted(spec.channelnames), sorted(names[:4]))
            types = dict(zip(spec.channelnames, map(str, spec.channelformats)))
            self.assertEqual({name for name, kind in types.items() if kind == "half"}, set(names[:2]))
            self.assertEqual(exr.metadata(target)["Camera"], "c")
            self.assertEqual(exr.metadata(target)["polyrecon/loop"], "digest")
            found = exr.read(target)
            self.assertLessEqual(found["V.Combined.R"].max(), 65504)
            np.testing.assert_array_equal(found["V.CryptoObject00.R"], channels["V.CryptoObject00.R"])
        target = self.folder / "colours.exr"
        colours = lambda name: "half" if "Combined." in name else None  # noqa: E731
        self.assertEqual(outputs.deliver(self.folder / "all.exr", target, colours, outputs.encoding("dwab", 200)), "")
        self.assertEqual(exr.metadata(target)["openexr:dwaCompressionLevel"], 200)
        self.assertLess(exr.read(target)["V.Combined.R"].max(), 65504)
        exact = np.clip(channels["V.Combined.R"], 0, 65504)
        found = exr.read(self.folder / "new" / "zip.exr")["V.Combined.R"]
        np.testing.assert_allclose(found, exact, rtol=2**-10)


if __name__ == "__main__":
    unittest.main()
