"""--with-prior: Open Image Denoise's picture takes part in the result."""

import os
import unittest

import numpy as np

from pipelines.common import exr
from tests.bench.relmse import relative_squares
from tests.pipelines.blender.support import SceneTest
from tests.pipelines.oidn import NO_OIDN, OIDN

SMALL = ("--first-pass", 4, "--quality", "draft", "--bpy")


def picture(path):
    found = exr.read(path)
    return np.stack([found[f"ViewLayer.Combined.{c}"] for c in "RGB"], -1)


class Prior(SceneTest):
    @unittest.skipUnless(OIDN, NO_OIDN)
    def test_it_lowers_the_error_of_few_samples(self):
        scene = self.scene("caustic")
        for name, *words in (
            ("reference.exr", "--budget-spp", 1024, "--max-rounds", 0),
            ("without.exr", "--budget-spp", 8),
            ("with.exr", "--budget-spp", 8, "--with-prior", "--keep-passes"),
        ):
            done = self.driver("adaptive.py", scene, "-o", name, *SMALL, *words, POLYRECON_OIDN=OIDN)
            self.assertEqual(done.returncode, 0, done.stderr)
        reference = picture(self.folder / "reference.exr")
        errors = {
            name: relative_squares(picture(self.folder / name), reference).mean()
            for name in ("with.exr", "without.exr")
        }
        self.assertLess(errors["with.exr"], errors["without.exr"])
        # What was rendered is the same: the noisy mean holds no prior.
        self.assertFalse([name for name in exr.names(self.folder / "with.passes/merged.exr") if "Prior" in name])

    def test_without_the_library_nothing_is_rendered(self):
        words = ["-o", "out.exr", *SMALL, "--budget-spp", 8, "--with-prior"]
        done = self.driver("adaptive.py", self.scene(), *words, POLYRECON_OIDN="/nowhere")
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("/nowhere", done.stderr)
        self.assertEqual(os.listdir(self.folder), ["plain.blend"])


if __name__ == "__main__":
    unittest.main()
