"""Files of the renderers that can be had here: every pass of theirs that has a role is found."""

import importlib.util
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

from pipelines.common import exr
from pipelines.common.polyrecon_cli import Polyrecon
from tests.pipelines.blender.support import BLENDER_3, NO_BLENDER_5_2, PYTHON_OF_BLENDER_5_2
from tests.pipelines.real_files.sampling_luxcore import Films, relmse

HERE = Path(__file__).parent
FEATURES = {"normal": "Denoising Normal", "albedo": "Denoising Albedo", "depth": "Denoising Depth"}


LUXCORE = {
    "beauty": "RGB_IMAGEPIPELINE",
    "normal": "AVG_SHADING_NORMAL",
    "albedo": "ALBEDO",
    "depth": "DEPTH",
    "sample-count": "SAMPLECOUNT",
    "alpha": "ALPHA",
}


class RealFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.polyrecon = Polyrecon()

    def render(self, command, *words):
        done = subprocess.run([*command, *map(str, words)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])

    def inspect(self, path):
        return json.loads(self.polyrecon.run("inspect", "--json", path))

    def chosen(self, path):
        """{(role, what the layer holds): layer} of the layers in use."""
        return {(role["role"], role["holds"]): role["layer"] for role in self.inspect(path)["roles"]}

    def merged(self, *paths, **options):
        out = self.folder / "merged.exr"
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        self.polyrecon.run("merge", *paths, "-o", out, *words)
        return out

    def denoised(self, path, *words):
        """The result and its report."""
        out, report = self.folder / "denoised.exr", self.folder / "report.json"
        self.polyrecon.run(
            "denoise", "-i", path, "-o", out, "--report", report, "--quality", "draft", "--quiet", *words
        )
        return exr.read(out), json.loads(report.read_text())


class Blender(RealFiles):
    def check(self, command, visibility, sky=0):
        """Renders two seeds; returns the roles of the layers of one render, and the channels of both merged.

        sky: the depth in the upper left corner."""
        paths = [self.folder / f"{seed}.exr" for seed in (1, 2)]
        for seed, path in enumerate(paths, 1):
            self.render(command, path, seed, 32)
        one = self.chosen(paths[0])
        expected = {"beauty": "Combined", **FEATURES, "visibility": visibility, "sample-count": "Debug Sample Count"}
        self.assertEqual(
            one, {(role, "mean"): f"ViewLayer.{name}" for role, name in expected.items()}, self.inspect(paths[0])
        )
        merged = self.merged(*paths)
        both = self.chosen(merged)
        for role in ("beauty", *FEATURES, "visibility"):
            for holds in ("mean", "variance of the mean", "half A", "half B"):
                self.assertIn((role, holds), both)
        planes = exr.read(merged)
        for name, plane in planes.items():
            if "Denoising" in name or "Combined" in name:
                self.assertTrue(np.isfinite(plane).all(), name)
        self.assertEqual(planes["ViewLayer.Denoising Depth.Z"][0, 0], sky)
        self.assertEqual(planes["ViewLayer.Denoising Depth Variance.Z"][0, 0], 0)
        picture, report = self.denoised(merged)
        self.assertEqual(report["repaired_pixels"], 0)
        self.assertTrue(np.isfinite(picture["ViewLayer.Combined.R"]).all())
        half = self.folder / "half.exr"
        self.render(command, half, 1, 16)
        self.assertEqual(self.chosen(half), one)
        self.assertEqual(self.denoised(half)[1]["repaired_pixels"], 0)
        return {layer["name"]: layer["role"] for layer in self.inspect(paths[0])["layers"]}, planes

    def test_3_4(self):
        script = HERE / "render_blender.py"
        command = [BLENDER_3, "-b", "-Y", "--factory-startup", "--python-exit-code", "7", "-P", script, "--"]
        self.check(command, "Shadow")

    def test_5_0(self):
        self.check([sys.executable, "-B", HERE / "render_blender.py"], "Ambient Occlusion")

    @unittest.skipUnless(PYTHON_OF_BLENDER_5_2, NO_BLENDER_5_2)
    def test_5_2(self):
        roles, merged = self.check(
            [PYTHON_OF_BLENDER_5_2, "-B", HERE / "render_blender.py"], "Ambient Occlusion", sky=1e10
        )
        self.assertEqual(roles["ViewLayer.Denoising Specular Albedo"], "specular-albedo")
        self.assertEqual(roles["ViewLayer.Denoising Roughness"], "roughness")
        for name in ("ViewLayer.Denoising Specular Albedo Variance.R", "ViewLayer.Denoising Roughness Variance.X"):
            self.assertIn(name, merged)


@unittest.skipUnless(importlib.util.find_spec("mitsuba"), "tests/pipelines/make_venv.sh installs Mitsuba")
class Mitsuba(RealFiles):
    def film(self, *parts, seed=1):
        path = self.folder / f"{'_'.join(parts)}_{seed}.exr"
        self.render([sys.executable, "-B", HERE / "render_mitsuba.py"], path, seed, *parts)
        return path

    def test_the_features_of_the_integrator_aov(self):
        path = self.film("aov", "path")
        found = self.chosen(path)
        self.assertEqual(
            found,
            {
                ("beauty", "mean"): "RGBA",
                ("normal", "mean"): "nn",
                ("albedo", "mean"): "albedo",
                ("depth", "mean"): "dd.y",
            },
        )
        merged = self.merged(path, self.film("aov", "path", seed=2), samples=16)
        both = self.chosen(merged)
        for role in ("beauty", "normal", "albedo", "depth"):
            for holds in ("mean", "variance of the mean", "half A", "half B"):
                self.assertIn((role, holds), both)
        self.denoised(merged)

    def test_the_second_moments_of_the_integrator_moment(self):
        path = self.film("moment", "aov", "path")
        self.assertEqual(
            self.chosen(path),
            {
                ("beauty", "mean"): "RGBA",
                ("beauty", "second moment"): "m2_img.img",
                ("normal", "mean"): "img.nn",
                ("normal", "second moment"): "m2_img.nn",
                ("albedo", "mean"): "img.albedo",
                ("albedo", "second moment"): "m2_img.albedo",
                ("depth", "mean"): "img.dd.y",
                ("depth", "second moment"): "m2_img.dd.y",
            },
        )
        # The file does not hold the number of samples, without which the moments say nothing.
        self.assertIn("the sample count is unknown; give --samples", " ".join(self.inspect(path)["notes"]))
        _, without = self.denoised(path)
        self.assertEqual(without["variance_source"], "estimated from the image")
        _, report = self.denoised(path, "--samples", 16)
        self.assertEqual(report["variance_source"], "from the file")

    def test_moments_of_a_nested_integrator_without_layers_are_those_of_cie_xyz(self):
        path = self.film("moment", "path")
        self.assertEqual(
            self.chosen(path),
            {("beauty", "mean"): "RGBA", ("beauty", "second moment of CIE XYZ"): "m2_img"},
        )
        _, report = self.denoised(path, "--samples", 16)
        self.assertEqual(report["variance_source"], "from the file")

    def test_moments_within_the_integrator_aov_and_of_other_films(self):
        for parts, found in (
            (("aov", "moment", "path"), {("beauty", "second moment of CIE XYZ"): "img.m2_img"}),
            (("moment", "aov", "path", "xyz"), {("beauty", "second moment"): "m2_img"}),
            (("moment", "path", "luminance"), {("beauty", "second moment"): "m2_img"}),
        ):
            with self.subTest(parts=parts):
                path = self.film(*parts)
                self.assertLessEqual(found.items(), self.chosen(path).items())
                _, report = self.denoised(path, "--samples", 16)
                self.assertEqual(report["variance_source"], "from the file")

    def test_a_lamp_beyond_what_the_default_film_of_halves_holds(self):
        path = self.film("path", "half")
        self.assertTrue(np.isinf(exr.read(path)["R"]).any())
        self.assertIn("count as 65504, the largest half", " ".join(self.inspect(path)["notes"]))
        picture, report = self.denoised(path)
        self.assertEqual(report["repaired_pixels"], 0)
        self.assertEqual(picture["R"].max(), 65504)
        merged = exr.read(self.merged(path, self.film("path", "half", seed=2)))
        self.assertTrue(all(np.isfinite(plane).all() for plane in merged.values()))
        self.assertEqual(merged["R"].max(), 65504)


@unittest.skipUnless(importlib.util.find_spec("pyluxcore"), "tests/pipelines/make_venv.sh installs LuxCore")
class LuxCore(RealFiles):
    def film(self, seed):
        prefix = self.folder / f"film{seed}_"
        self.render([sys.executable, "-B", HERE / "render_luxcore.py"], prefix, seed)
        return Path(f"{prefix}RGB_IMAGEPIPELINE.exr")

    def test_the_files_next_to_the_picture(self):
        path = self.film(1)
        found = {role: layer.strip("_") for (role, _), layer in self.chosen(path).items()}
        self.assertEqual(found, LUXCORE)
        self.assertGreaterEqual(self.inspect(path)["samples"], 8)
        _, report = self.denoised(path)
        self.assertEqual(report["repaired_pixels"], 0)  # its sky is +Inf

    def test_merged_renders_keep_the_passes(self):
        merged = self.merged(self.film(1), self.film(2))
        both = self.chosen(merged)
        for role in ("beauty", "normal", "albedo", "depth"):
            self.assertEqual(both[role, "mean"], LUXCORE[role])
            for holds in ("variance of the mean", "half A", "half B"):
                self.assertIn((role, holds), both)
        self.assertEqual(both["sample-count", "mean"], "Sample Count")
        self.assertEqual(both["alpha", "mean"], "ALPHA")
        planes = exr.read(merged)
        ones = [exr.read(self.folder / f"film{seed}_SAMPLECOUNT.exr")["R"] for seed in (1, 2)]
        np.testing.assert_allclose(planes["Sample Count.X"], sum(ones))
        pictures = [exr.read(self.folder / f"film{seed}_RGB_IMAGEPIPELINE.exr")["G"] for seed in (1, 2)]
        mean = sum(n * picture for n, picture in zip(ones, pictures)) / sum(ones)
        np.testing.assert_allclose(planes["RGB_IMAGEPIPELINE.G"], mean, rtol=1e-5)
        self.assertIn("DIRECT_DIFFUSE.R", planes)
        np.testing.assert_array_equal(planes["POSITION.R"], exr.read(self.folder / "film1_POSITION.exr")["R"])
        _, report = self.denoised(merged)
        self.assertEqual(report["variance_source"], "from the file")

    def test_samples_follow_the_map_of_samplemap(self):
        films = Films(self.folder)
        pictures, counts, importance = films.two_rounds(0)
        placed, even = ([np.mean(one) for one in each] for each in counts)
        self.assertAlmostEqual(sum(placed) / sum(even), 1, delta=0.05)
        # The upper half of the map differs from the lower one, so a map upside down would not correlate.
        taken = counts[0][0] + counts[0][1]
        self.assertGreater(np.corrcoef(taken.ravel(), importance.ravel())[0, 1], 0.95)
        self.assertLess(np.corrcoef(taken.ravel(), importance[::-1].ravel())[0, 1], 0.7)
        reference = films.reference(1024)
        self.assertLess(relmse(pictures[0], reference), 0.8 * relmse(pictures[1], reference))


if __name__ == "__main__":
    unittest.main()
