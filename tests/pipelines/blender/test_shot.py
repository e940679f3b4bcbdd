"""A shot with one budget: four frames, of which one is much noisier (make_scene.py: shot)."""

import json
import os
import subprocess
import sys
import time
import unittest

import numpy as np

from pipelines.blender.renderer import BlenderRenderer
from pipelines.common import exr
from pipelines.loop.renderer import SAMPLE_COUNT
from tests.bench import relmse
from tests.pipelines.blender.support import ROOT, SceneTest

FRAMES, NOISY = (1, 2, 3, 4), 3
SPP, REFERENCE_SPP = 24, 768
PICTURE = [f"ViewLayer.Combined.{c}" for c in "RGB"]


class Shots(SceneTest):
    def words(self, scene, output, *more):
        words = [scene, "-o", output, "--frames", "1-4", "--budget-spp", SPP, "--quality", "draft", "--keep-passes"]
        return list(map(str, [*words, "--bpy", *more]))

    def run_driver(self, *words):
        done = self.driver(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def kill_at(self, file, *words):
        child = subprocess.Popen(
            [sys.executable, ROOT / "pipelines" / "blender" / "adaptive.py", *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        while not file.exists():
            self.assertIsNone(child.poll())
            time.sleep(0.005)
        child.kill()
        child.wait()

    def pictures(self, pattern):
        files = [exr.read(str(pattern).replace("#", str(n))) for n in FRAMES]
        return [np.stack([channels[name] for name in PICTURE], -1).astype(float) for channels in files]

    def journals(self, name):
        passes = self.folder / f"{name}.passes"
        return {n: json.loads((passes / f"{n:04}" / "journal.json").read_text()) for n in FRAMES}

    def test_the_noisy_frame_gets_more_and_a_killed_run_goes_on_to_the_same_pictures(self):
        scene = self.scene("shot")
        whole, broken = self.folder / "whole_#.exr", self.folder / "broken_#.exr"
        said = self.run_driver("adaptive.py", *self.words(scene, whole, "--report", self.folder / "report_#.html"))
        self.assertRegex(said, r"shot: 4 frames, 48 x 28, .* samples per pixel on average")
        where = f"{self.folder}/whole.passes"
        last = rf"  passes in {where} \([\d.]+ MB\): --resume continues with them, `rm -r {where}` removes them"
        self.assertRegex(said.splitlines()[-1], f"^{last}$")

        samples = {n: sum(part["samples"] for part in entry["parts"]) for n, entry in self.journals("whole").items()}
        self.assertGreater(samples[NOISY], 1.5 * SPP)
        self.assertLessEqual(sum(samples.values()), 1.02 * SPP * len(FRAMES))
        page = (self.folder / "report.html").read_text()
        for n in FRAMES:
            self.assertIn(f'href="report_{n}.html"', page)
            self.assertTrue((self.folder / f"report_{n}.html").exists())
            merged = exr.read(self.folder / "whole.passes" / f"{n:04}" / "merged.exr")
            self.assertIn("ViewLayer.Vector.X", merged)
            self.assertAlmostEqual(merged[f"ViewLayer.{SAMPLE_COUNT}"].mean(), samples[n], delta=1e-3 * samples[n])

        # The same samples, divided evenly between frames and pixels.
        options = ["--frames", "1-4", "--bpy"]
        even, clean = self.folder / "even_#.exr", self.folder / "clean_#.exr"
        self.run_driver("render_passes.py", scene, "-o", even, "--spp", SPP, *options)
        denoise = ["denoise", "-i", even, "-o", clean, "--quality", "draft", "--quiet"]
        subprocess.run([os.environ["POLYRECON"], *map(str, denoise)], check=True)
        reference = self.folder / "reference_#.exr"
        self.run_driver("render_passes.py", scene, "-o", reference, "--spp", REFERENCE_SPP, "--parts", 2, *options)
        true = self.pictures(reference)
        shared, divided = (
            np.mean([relmse.relative_squares(a, b).mean() for a, b in zip(self.pictures(pattern), true)])
            for pattern in (whole, clean)
        )
        self.assertLess(shared, divided)

        self.kill_at(self.folder / "broken.passes" / f"{NOISY:04}" / "part_1a0.exr", *self.words(scene, broken))
        self.run_driver("adaptive.py", *self.words(scene, broken, "--resume"))
        for a, b in zip(self.pictures(whole), self.pictures(broken)):
            np.testing.assert_array_equal(a, b)
        parts = [
            {
                n: [[part["file"], part["samples"]] for part in entry["parts"]]
                for n, entry in self.journals(name).items()
            }
            for name in ("whole", "broken")
        ]
        self.assertEqual(*parts)


class Frames(SceneTest):
    def renderer(self, kind, shot):
        renderer = BlenderRenderer(self.scene(kind), "bpy")
        self.addCleanup(renderer.close)
        renderer.shot = shot
        return renderer

    def part(self, renderer, frame, first=0):
        renderer.begin(frame)
        renderer.uniform(first, 4, self.folder / "part.exr")
        return exr.read(self.folder / "part.exr")

    def test_motion_vectors_come_once_with_motion_blur_too_and_change_no_sample(self):
        for kind, moves in (("moving", 10), ("plain", 0)):
            with self.subTest(kind):
                renderer = self.renderer(kind, shot=True)
                first, later = self.part(renderer, 2), self.part(renderer, 2, first=4)
                vectors = np.abs(first["ViewLayer.Vector.X"])  # The sphere moves by 17 pixels a frame.
                self.assertTrue(moves <= vectors.max() <= 48, vectors.max())
                self.assertNotIn("ViewLayer.Vector.X", later)
                self.assertIn("ViewLayer.Vector", renderer._audit().working)
                again = self.part(renderer, 2)
                for name in PICTURE:
                    np.testing.assert_allclose(again[name], first[name], rtol=1e-4, atol=1e-5)
                alone = self.part(self.renderer(kind, shot=False), 2, first=0)
                self.assertNotIn("ViewLayer.Vector.X", alone)
                self.assertAlmostEqual(first[PICTURE[0]].mean() / alone[PICTURE[0]].mean(), 1, delta=0.05)

    def test_each_frame_of_a_shot_has_samples_of_its_own(self):
        for shot in (True, False):
            renderer = self.renderer("plain", shot)  # Nothing moves.
            one, two = (self.part(renderer, n)[PICTURE[0]] for n in (1, 2))
            self.assertEqual(bool((one != two).mean() > 0.5), shot)
            np.testing.assert_allclose(self.part(renderer, 1)[PICTURE[0]], one, rtol=1e-4, atol=1e-5)


if __name__ == "__main__":
    unittest.main()
