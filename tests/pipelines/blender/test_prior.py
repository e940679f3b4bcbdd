"""--with-prior adds its layers, and each comes from its half alone."""

import json
import unittest

import numpy as np

from pipelines.blender import prior
from pipelines.blender.session import BlenderSession
from pipelines.common import exr
from pipelines.common.polyrecon_cli import Polyrecon
from tests.pipelines.blender.support import BLENDER_3, SceneTest

PRIORS = {f"ViewLayer.Prior {half}.{c}" for half in "AB" for c in "RGB"}


class Prior(SceneTest):
    def test_render_passes(self):
        done = self.driver("render_passes.py", self.scene(), "-o", "prior.exr", "--spp", 8, "--bpy", "--with-prior")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["plain.blend", "prior.exr"])
        found = exr.read(self.folder / "prior.exr")
        self.assertLessEqual(PRIORS, set(found))

        def roughness(layer):
            return np.abs(np.diff(found[f"ViewLayer.{layer}.G"], axis=1)).mean()

        for half in "AB":
            self.assertLess(roughness(f"Prior {half}"), 0.7 * roughness(f"Combined {half}"))

        # Half B changes, and prior A does not.
        other = {name: plane[:, ::-1] if " B." in name else plane for name, plane in found.items()}
        exr.write(self.folder / "other.exr", other)
        with BlenderSession("bpy") as session:
            prior.add(self.folder / "other.exr", "ViewLayer", session)
        again = exr.read(self.folder / "other.exr")
        for c in "RGB":
            np.testing.assert_array_equal(again[f"ViewLayer.Prior A.{c}"], found[f"ViewLayer.Prior A.{c}"])
            self.assertGreater(np.abs(again[f"ViewLayer.Prior B.{c}"] - found[f"ViewLayer.Prior B.{c}"]).max(), 0.01)

        roles = json.loads(Polyrecon().run("inspect", "--json", self.folder / "prior.exr"))["roles"]
        priors = {role["layer"] for role in roles if role["role"] == "prior"}
        self.assertEqual(priors, {"ViewLayer.Prior", "ViewLayer.Prior A", "ViewLayer.Prior B"})

    def test_the_loop(self):
        done = self.driver(
            "adaptive.py",
            self.scene(),
            "-o",
            "out.exr",
            "--budget-spp",
            8,
            "--first-pass",
            4,
            "--quality",
            "draft",
            "--bpy",
            "--with-prior",
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Prior A, B", (self.folder / "out.passes" / "report.html").read_text())
        self.assertLessEqual(PRIORS, set(exr.read(self.folder / "out.passes" / "merged.exr")))

    @unittest.skipUnless(BLENDER_3, "no blender on the path")
    def test_a_blender_without_the_denoiser_is_told(self):
        scene = self.scene(blender=BLENDER_3)
        done = self.driver(
            "render_passes.py", scene, "-o", "out.exr", "--spp", 8, "--blender", BLENDER_3, "--with-prior"
        )
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("OpenImageDenoise", done.stderr)


if __name__ == "__main__":
    unittest.main()
