import json
import os
import pathlib
import subprocess
import sys
import unittest

import numpy as np

from pipelines.common import exr
from pipelines.common.polyrecon_cli import Polyrecon

from .scenes import BALL, CAMERA, HEAD, LAMP, NOISY_LAMP, SIZE, InFolder

DRIVER = pathlib.Path(__file__).parents[3] / "pipelines" / "povray" / "render_passes.py"


class RenderPasses(InFolder):
    def run_driver(self, *words, code=0):
        done = subprocess.run([sys.executable, "-B", DRIVER, *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def test_a_noisy_scene(self):
        scene = self.scene(HEAD % 1 + CAMERA + BALL + NOISY_LAMP, "ba'll ü.pov")
        before = scene.stat()
        said = self.run_driver(scene, "-o", "merged.exr", "-v", "--", *SIZE).stdout
        self.assertIn("yes more subpixels", said)
        self.assertEqual(
            (scene.stat().st_mtime_ns, sorted(os.listdir())), (before.st_mtime_ns, [scene.name, "merged.exr"])
        )

        merged = exr.read("merged.exr")
        layers = {
            "Combined": "RGB",
            "Denoising Albedo": "RGB",
            "Denoising Normal": "XYZ",
            "Denoising Depth": "Z",
            "Visibility": "X",
        }
        names = {
            f"{layer}{kind}.{c}" for layer, cs in layers.items() for kind in ("", " Variance", " A", " B") for c in cs
        }
        self.assertEqual(set(merged), names | {"Sample Count.X"})
        self.assertTrue(all(np.isfinite(plane).all() and plane.shape == (48, 64) for plane in merged.values()))
        # The wall outside the ball's shadow has no noise.
        self.assertEqual(set(np.unique(merged["Sample Count.X"])), {4, 20})

        roles = json.loads(Polyrecon().run("inspect", "--json", "merged.exr"))["roles"]
        found = {(role["role"], role["holds"]) for role in roles}
        for role in ("beauty", "albedo", "normal", "depth", "visibility"):
            for holds in ("mean", "variance of the mean", "half A", "half B"):
                self.assertIn((role, holds), found)

        # The reconstruction is nearer to a render of 400 samples per pixel than the noisy mean.
        self.run_driver(scene, "-o", "reference.exr", "--subpixels", "20", "--", *SIZE)
        Polyrecon().run("denoise", "-i", "merged.exr", "-o", "clean.exr", "--quiet")
        errors = {image["image"]: image["relMSE"] for image in self.compare("merged.exr", "clean.exr")}
        self.assertLess(errors["clean.exr"], 0.6 * errors["merged.exr"])

    def compare(self, *images):
        return json.loads(Polyrecon().run("compare", "--json", *images, "reference.exr"))["results"]

    def test_a_scene_without_noise_is_left_at_the_first_pass_and_as_it_is(self):
        scene = self.scene(HEAD % 1 + CAMERA + BALL + LAMP)
        said = self.run_driver(scene, "-o", "new/folder/merged.exr", "--subpixels", "8", "-v", "--", *SIZE).stdout
        self.assertIn("no  more subpixels", said)
        pathlib.Path("new/folder/merged.exr").rename("merged.exr")
        merged = exr.read("merged.exr")
        self.assertEqual(set(np.unique(merged["Sample Count.X"])), {4})
        Polyrecon().run("denoise", "-i", "merged.exr", "-o", "clean.exr", "--quiet")
        clean = exr.read("clean.exr")
        for c in "RGB":
            np.testing.assert_array_equal(clean[f"Combined.{c}"], merged[f"Combined.{c}"])

    def test_wrong_use(self):
        scene = self.scene(HEAD % 1 + CAMERA + BALL + LAMP)
        self.run_driver(scene, "-o", "m.exr", "--camera", "1,2", code=2)
        self.run_driver(scene, "-o", "m.exr", "--subpixels", "1", code=2)
        self.run_driver(scene, "-o", "scene.pov/m.exr", "--", *SIZE, code=5)
        self.assertIn("did you mean --subpixels?", self.run_driver(scene, "-o", "m.exr", "--supixels=3", code=2).stderr)
        self.run_driver("none.pov", "-o", "m.exr", code=4)
        self.assertEqual(os.listdir(), ["scene.pov"])


if __name__ == "__main__":
    unittest.main()
