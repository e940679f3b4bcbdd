import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

import numpy as np

from pipelines.common import exr
from pipelines.povray.scene import Scene
from pipelines.povray.subpixels import estimate
from tests.bench.relmse import relative_squares
from tests.pipelines.oidn import NO_OIDN, OIDN

from .scenes import BALL, CAMERA, HEAD, NOISY_LAMP, SIZE, InFolder

DRIVER = pathlib.Path(__file__).parents[3] / "pipelines" / "povray" / "adaptive.py"


class Adaptive(InFolder):
    def command(self, *words):
        return [sys.executable, "-B", DRIVER, "ball.pov", "-o", "ball.exr", "--keep-passes", *words, "--", *SIZE]

    def run_driver(self, *words, code=0):
        environment = {**os.environ, "POLYRECON_OIDN": OIDN}
        done = subprocess.run(self.command(*words), capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def test_killed_resumed_and_within_its_budget(self):
        self.scene(HEAD % 1 + CAMERA + BALL + NOISY_LAMP, "ball.pov")
        killed = subprocess.Popen(self.command("--budget-spp", "48"), stderr=subprocess.DEVNULL)
        while not pathlib.Path("ball.passes/part_0b1.exr").exists():
            self.assertIsNone(killed.poll())
            time.sleep(0.05)
        killed.send_signal(signal.SIGTERM)
        self.assertEqual(killed.wait(20), 143)
        self.assertFalse(pathlib.Path("ball.exr").exists())
        done = self.run_driver("--budget-spp", "48", code=2)
        self.assertIn("ball.passes/journal.json: passes of an earlier run", done.stderr)
        said = self.run_driver("--budget-spp", "48", "--resume").stdout
        self.assertIn("passes in ball.passes (", said)

        journal = json.loads(pathlib.Path("ball.passes/journal.json").read_text())
        # A pass is never empty, so the last one may exceed the budget by a row.
        self.assertLess(sum(part["samples"] for part in journal["parts"]), 48 + 1)
        self.assertGreater(len(journal["rounds"]), 1)
        names = [part["file"] for part in journal["parts"]]
        self.assertEqual(len(names), len(set(names)))
        merged = exr.read("ball.passes/merged.exr")
        counts = merged["Sample Count.X"]
        np.testing.assert_allclose(counts.mean(), sum(part["samples"] for part in journal["parts"]), rtol=1e-6)
        for layer in ("Combined Variance.R", "Denoising Normal Variance.X", "Denoising Depth.Z", "Visibility A.X"):
            self.assertIn(layer, merged)
        # The penumbra on the wall has noise, and gets more samples.
        with Scene("ball.pov", SIZE) as scene:
            reference = estimate(scene.render(20), 20)
        noisy = reference.variance.mean(-1) > np.quantile(reference.variance.mean(-1), 0.9)
        self.assertGreater(counts[noisy].mean(), 1.3 * counts[~noisy].mean())
        # The noisy picture is unbiased, and the clean one is nearer to the reference.
        errors = [
            relative_squares(np.stack([found[f"Combined.{c}"] for c in "RGB"], -1), reference.mean).mean()
            for found in (merged, exr.read("ball.exr"))
        ]
        self.assertLess(errors[1], errors[0])
        self.assertTrue(os.path.getsize("ball.passes/report.html") > 10000)

    def test_the_frames_of_a_shot_share_its_budget(self):
        """The lamp is noisy in the second of three frames only."""
        plain = "light_source { <0, 3, -2> rgb 1 }\n"
        lamps = f"#if (frame_number = 2)\n{NOISY_LAMP}#else\n{plain}#end\n"
        self.scene(HEAD % 1 + CAMERA + BALL + lamps, "ball.pov")
        command = self.command("--budget-spp", "32", "--frames", "1-3", "--quality", "draft")
        command[command.index("ball.exr")] = "ball_#.exr"
        done = subprocess.run([*command, "+KFF3"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"shot: 3 frames, .* samples per pixel on average")
        counts = [exr.read(f"ball.passes/000{n}/merged.exr")["Sample Count.X"].mean() for n in (1, 2, 3)]
        self.assertGreater(counts[1], max(counts[0], counts[2]))
        self.assertLess(sum(counts), 3 * (32 + 1))
        for n in (1, 2, 3):
            self.assertIn("Denoising Normal.X", exr.read(f"ball.passes/000{n}/merged.exr"))

    def test_case34_a_scene_without_noise_ends_after_the_first_pass(self):
        # The camera sees an even wall, so all subpixels are equal.
        wall = "plane { -z, -2 hollow pigment { rgb <0.5,0.25,0.125> } finish { ambient 1 diffuse 0 } }\n"
        self.scene(HEAD % 1 + CAMERA + wall, "ball.pov")
        said = self.run_driver("--budget-spp", "48").stdout
        self.assertIn("no error is left that more samples could lower", said)
        self.assertEqual(set(exr.read("ball.passes/merged.exr")["Sample Count.X"].flat), {16})

    @unittest.skipUnless(OIDN, NO_OIDN)
    def test_open_image_denoise_takes_part(self):
        self.scene(HEAD % 1 + CAMERA + BALL + NOISY_LAMP, "ball.pov")
        pictures = []
        for words in ([], ["--with-prior"]):
            self.run_driver("--budget-spp", "20", "--quality", "draft", *words)
            pictures.append(exr.read("ball.exr"))
            for path in ("ball.passes", "ball.exr"):
                shutil.rmtree(path) if os.path.isdir(path) else os.unlink(path)
        change = np.abs(pictures[0]["Combined.G"] - pictures[1]["Combined.G"])
        self.assertGreater(change.max(), 1e-3)
        self.assertLess(change.mean(), 0.02)

    def test_wrong_use(self):
        self.scene(HEAD % 1 + CAMERA + BALL + NOISY_LAMP, "ball.pov")
        self.run_driver("--budget-spp", "8", code=2)
        self.run_driver("--budget-spp", "64", "--first-pass", "8", code=2)
        self.run_driver(code=2)
        self.assertEqual(os.listdir(), ["ball.pov"])
