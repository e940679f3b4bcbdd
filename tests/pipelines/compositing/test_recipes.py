"""Runs the recipes of docs/guide/scripting.md and compositing.md as they are, and checks their results."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import OpenImageIO as oiio

from pipelines.common.exr import read

PROGRAM = os.environ["POLYRECON"]
SAMPLES = pathlib.Path(os.environ["POLYRECON_SAMPLES"])
COMPOSITING = SAMPLES.parent / "pipelines" / "compositing"
GUIDE = SAMPLES.parent / "docs" / "guide"


def layer(found, name=""):
    return np.stack([found[f"{name}.{c}" if name else c] for c in "RGB"], -1).astype(np.float64)


def same_bits(a, b):
    return a.shape == b.shape and np.array_equal(np.ascontiguousarray(a).view("u4"), np.ascontiguousarray(b).view("u4"))


def blocks(page, language):
    """The page's code blocks in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", (GUIDE / page).read_text(), re.M | re.S)


def run(words, folder, environment=None):
    words = [str(word) for word in words]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{words}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Recipes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        shutil.copy(SAMPLES / "glass_16.exr", cls.folder / "render.exr")
        shutil.copy(SAMPLES / "lighthouse_16.exr", cls.folder / "parts.exr")
        parts = sorted(SAMPLES.glob("study_small_[0-3].exr"))
        run([PROGRAM, "merge", *parts, "-o", "groups.exr", "--quiet"], cls.folder)
        recipes = blocks("scripting.md", "sh") + blocks("compositing.md", "sh")
        (cls.folder / "recipes.sh").write_text("set -euo pipefail\n" + "".join(recipes))
        # The names of programs in the recipes; oiiotool is Debian's, even if the PATH has another one.
        (cls.folder / "bin").mkdir()
        for name, target in (("polyrecon", PROGRAM), ("oiiotool", "/usr/bin/oiiotool")):
            (cls.folder / "bin" / name).symlink_to(target)
        path = f"{cls.folder}/bin:{os.environ['PATH']}"
        environment = dict(os.environ, PATH=path, COMPOSITING=str(COMPOSITING))
        (script,) = blocks("scripting.md", "python")
        cls.printed = run([sys.executable, "-c", script], cls.folder, environment)
        done = subprocess.run(
            ["bash", "recipes.sh"],
            cwd=cls.folder,
            env=environment,
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
        )
        if done.returncode != 0:
            raise AssertionError(f"the recipes end with {done.returncode}: {done.stdout}\n{done.stderr}")

    def read(self, name):
        if name.endswith(".exr"):
            return read(self.folder / name)
        picture = oiio.ImageBuf(str(self.folder / name))
        return dict(zip(picture.spec().channelnames, np.moveaxis(picture.get_pixels("float"), -1, 0)))

    def test_the_steps_of_a_script_leave_what_they_say(self):
        lines = (self.folder / "progress.jsonl").read_text().splitlines()
        self.assertTrue(lines and all(line.startswith('{"event":') for line in lines), lines[:3])
        self.assertIn("estimated relMSE", (self.folder / "report.txt").read_text())

    def test_a_script_in_python_reads_the_report(self):
        self.assertRegex(self.printed, r"^estimated relMSE: 0\.0\d+\n")

    def test_the_review_picture_is_the_beauty_in_srgb(self):
        clean = np.clip(layer(self.read("clean.exr"), "ViewLayer.Combined"), 0, 1)
        shown = np.where(clean <= 0.0031308, 12.92 * clean, 1.055 * np.maximum(clean, 1e-9) ** (1 / 2.4) - 0.055)
        self.assertLess(np.abs(layer(self.read("review.png")) - shown).max(), 1.01 / 255)

    def test_one_part_is_taken_out_as_it_is(self):
        clean, beauty = self.read("parts_clean.exr"), self.read("beauty.exr")
        self.assertEqual(sorted(beauty), ["A", "B", "G", "R"])
        for c in "RGBA":
            self.assertTrue(same_bits(beauty[c], clean[f"ViewLayer.Combined.{c}"]), c)

    def test_grain_is_a_fifth_of_the_noise(self):
        clean, noisy = (
            layer(self.read("clean.exr"), "ViewLayer.Combined"),
            layer(self.read("render.exr"), "ViewLayer.Combined"),
        )
        np.testing.assert_allclose(layer(self.read("grain.exr")), 0.8 * clean + 0.2 * noisy, rtol=2e-3, atol=1e-4)

    def test_the_mask_is_where_the_error_is(self):
        error, mask = self.read("error.exr")["relmse.Y"], next(iter(self.read("doubtful.png").values()))
        self.assertTrue(0.001 < mask.mean() < 0.999, mask.mean())
        decided = np.abs(error - 0.01) > 1e-5
        self.assertTrue(np.array_equal((mask > 0.5)[decided], (error > 0.01)[decided]))

    def test_what_was_removed_is_shown_about_grey(self):
        removed = layer(self.read("render.exr"), "ViewLayer.Combined") - layer(
            self.read("clean.exr"), "ViewLayer.Combined"
        )
        np.testing.assert_allclose(layer(self.read("removed.exr")), 10 * removed + 0.5, rtol=2e-3, atol=1e-2)

    def test_light_groups_are_mixed_anew(self):
        clean = self.read("groups_clean.exr")
        day, lamp, whole = (layer(clean, f"ViewLayer.Combined{group}") for group in ("_daylight", "_lamp", ""))
        self.assertLess((np.abs(day + lamp - whole) / (whole + 0.01)).max(), 1e-3)
        np.testing.assert_allclose(layer(self.read("relit.exr")), 0.5 * day + 2 * lamp, rtol=2e-3, atol=1e-4)

    # Blender 3.4 as in the recipes, and Blender 5 as the module of this Python.

    def layers(self, text):
        return [line.removeprefix("layer: ") for line in text.splitlines() if line.startswith("layer: ")]

    def blender_5(self, *words):
        return run([sys.executable, COMPOSITING / "blender_comp.py", *words], self.folder)

    def check_layers(self, found, path):
        """All layers of the file. Blender lists the alpha of a beauty as a layer."""
        names = {name.rpartition(".")[0].removeprefix("ViewLayer.") for name in read(self.folder / path)}
        self.assertGreater(len(names), 5)
        self.assertEqual(set(found), names | {"Alpha"})

    def test_blender_finds_every_layer(self):
        self.check_layers(self.layers((self.folder / "layers.txt").read_text()), "clean.exr")
        for path in ("clean.exr", "parts_clean.exr"):
            self.check_layers(self.layers(self.blender_5(path, "--list")), path)

    def test_cryptomatte_still_mattes(self):
        objects = ("--object", "Torus", "--object", "Sphere.002", "--exposure", 1)
        self.blender_5("render.exr", "-o", "render_graded.exr", *objects)
        self.blender_5("clean.exr", "-o", "graded_5.exr", *objects)
        matte = self.read("render_graded.exr")["A"]
        self.assertTrue(0.02 < matte.mean() < 0.3, matte.mean())
        clean = layer(self.read("clean.exr"), "ViewLayer.Combined")
        for path in ("graded.exr", "graded_5.exr"):
            graded = self.read(path)
            self.assertTrue(same_bits(graded["A"], matte), path)
            np.testing.assert_allclose(layer(graded), clean * 2 ** matte[..., None], rtol=1e-4, atol=1e-6)

    def test_cryptomatte_of_a_file_with_a_part_for_each_pass(self):
        for name in ("parts", "parts_clean"):
            self.blender_5(f"{name}.exr", "-o", f"{name}_graded.exr", "--object", "Cone", "--exposure", 1)
        matte = self.read("parts_graded.exr")["A"]
        self.assertTrue(0.001 < matte.mean() < 0.3, matte.mean())
        self.assertTrue(same_bits(self.read("parts_clean_graded.exr")["A"], matte))


if __name__ == "__main__":
    unittest.main()
