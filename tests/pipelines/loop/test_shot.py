import json
import math
import os
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

from pipelines.common import exr
from pipelines.common.command import Frame
from pipelines.common.errors import DriverError, ExitCode, run_main
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.common.progress import Progress
from pipelines.loop import command, shot, shot_decision, shot_report
from pipelines.loop.budget import Budget
from pipelines.loop.frame import Settings
from pipelines.loop.journal import HALVES
from pipelines.loop.reconstruction import Reconstruction
from pipelines.loop.shot_frame import ShotFrame
from tests.pipelines.loop.synthetic import SyntheticRenderer

ROOT = Path(__file__).resolve().parents[3]
FRAMES, NOISY = (1, 2, 3), 2


class SyntheticShot(SyntheticRenderer):
    """Three frames of the same picture. The second has a hundred times the variance of the others."""

    def __init__(self):
        super().__init__(width=48, height=32)
        self.spreads = {n: np.full(self.mean.shape, 6.0 if n == NOISY else 0.06) for n in FRAMES}
        self.begun = []

    def begin(self, frame):
        self.spread, self.seed = self.spreads[frame], frame
        self.begun.append(frame)
        return super().begin(frame)


def settings_of(folder, budget, resume=False, **more):
    folder = Path(folder)
    return [
        Settings(
            Frame(n, folder / f"{n}.passes", folder / f"{n}.exr"),
            budget,
            resume=resume,
            quality="draft",
            shot=FRAMES,
            **more,
        )
        for n in FRAMES
    ]


def run(folder, budget, renderer=None, **more):
    renderer = renderer or SyntheticShot()
    return renderer, shot.run(renderer, Polyrecon(), settings_of(folder, budget, **more), Progress("none"))


def samples_of(result):
    return {settings.files.number: frame.samples for settings, frame in result.frames}


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class Budgets(Folder):
    def test_samples_go_to_the_noisy_frame_and_their_mean_is_the_budget(self):
        renderer, result = run(self.folder, Budget(samples=24))
        samples = samples_of(result)
        self.assertGreater(samples[NOISY], 3 * max(samples[1], samples[3]))
        self.assertLessEqual(result.samples, 24 * 1.02)
        self.assertGreater(result.samples, 22)
        self.assertEqual(result.why_ended, "the samples are spent")
        self.assertEqual(renderer.begun[: len(FRAMES)], list(FRAMES))
        self.assertTrue(renderer.shot)
        for settings, frame in result.frames:
            self.assertTrue(np.isfinite(exr.read(settings.files.output)["L.Combined.R"]).all())
            self.assertEqual(frame.error, float(np.nanmean(exr.read(frame.error_map)["relmse.Y"])))
        self.assertIn(
            f"3 frames, 48 x 32, synthetic, {result.samples:.3g} samples per pixel on average",
            "\n".join(shot_report.lines(result, False, Polyrecon())),
        )

    def test_seconds_are_those_of_all_frames(self):
        budget = 4.0 * len(FRAMES)
        with unittest.mock.patch.object(shot_decision, "MAX_DECISION_SHARE", 100.0):  # Decisions pay in so few seconds.
            _, result = run(self.folder, Budget(seconds=budget))
        parts = [part.seconds for _, frame in result.frames for part in frame.state.parts]
        # The last pass may begin just before the end. What the result takes is kept in reserve, and more or less.
        rendering = sum(frame.seconds for _, frame in result.frames)
        self.assertLess(rendering, budget + max(parts))
        self.assertLess(rendering, result.seconds)

    def test_where_decisions_take_too_long_the_noise_decides(self):
        # Nothing is kept in reserve, so that a busy machine has seconds left after the first pass.
        with unittest.mock.patch.multiple(shot_decision, MAX_DECISION_SHARE=1e-6, NEIGHBOURS_OVER_ALONE={"draft": 0.0}):
            _, result = run(self.folder, Budget(seconds=10))
        self.assertEqual([frame.state.rounds for _, frame in result.frames], [[], [], []])
        samples = samples_of(result)
        self.assertGreater(samples[NOISY], max(samples[1], samples[3]))

    def test_a_target_is_that_of_the_mean(self):
        _, result = run(self.folder, Budget(target=0.01))
        errors = [frame.state.error for _, frame in result.frames]
        self.assertLessEqual(sum(errors) / len(errors), 0.01)
        self.assertIn("the target is reached", result.why_ended)
        samples = samples_of(result)
        self.assertGreater(samples[NOISY], max(samples[1], samples[3]))

    def test_a_shot_without_noise_ends_at_once_and_says_why(self):
        renderer = SyntheticShot()
        renderer.sample = lambda number: renderer.mean
        _, result = run(self.folder, Budget(samples=64), renderer)
        self.assertEqual(set(samples_of(result).values()), {8})
        self.assertEqual(result.why_ended, "no error is left that more samples could lower")

    def test_rounds_of_each_frame_are_limited(self):
        _, result = run(self.folder, Budget(samples=64), max_rounds=1)
        self.assertEqual(result.why_ended, "--max-rounds 1 is reached")
        for _, frame in result.frames:
            self.assertLessEqual(max(part.round for part in frame.state.parts), 1)


class Passes(Folder):
    def test_passes_of_a_frame_by_itself_are_refused(self):
        run(self.folder, Budget(samples=8))
        alone = Settings(Frame(1, self.folder / "1.passes", self.folder / "1.exr"), Budget(samples=8), resume=True)
        with self.assertRaisesRegex(DriverError, "cannot continue: 'shot' was True") as caught:
            command.one_frame(alone, False, SyntheticShot(), Polyrecon(), Progress("none"), lambda notes: None)
        self.assertEqual(caught.exception.code, ExitCode.USAGE)

    def test_a_larger_budget_continues(self):
        _, small = run(self.folder, Budget(samples=12))
        before = {settings.files.number: list(frame.state.parts) for settings, frame in small.frames}
        _, large = run(self.folder, Budget(samples=24), resume=True)
        for settings, frame in large.frames:
            first = before[settings.files.number]
            self.assertEqual(frame.state.parts[: len(first)], first)
        self.assertGreater(large.samples, small.samples + 8)

    def test_a_finished_shot_is_left_alone_and_a_part_of_one_refused(self):
        budget = Budget(samples=8)
        words = (None, False, SyntheticShot(), Polyrecon(), Progress("none"), lambda notes: None)
        settings = settings_of(self.folder, budget)
        command.whole_shot(settings, *words)
        self.assertEqual(command.end_of_passes(settings), [])
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["1.exr", "2.exr", "3.exr"])
        again = settings_of(self.folder, budget, resume=True)
        self.assertTrue(command.is_finished(again, overwrite=False))
        with self.assertRaisesRegex(DriverError, "not from this scene with these options"):
            command.is_finished(settings_of(self.folder, Budget(samples=9), resume=True), overwrite=False)
        (self.folder / "2.exr").unlink()
        with self.assertRaisesRegex(DriverError, "1.exr: is finished and its passes are gone, but other frames"):
            command.is_finished(again, overwrite=False)

    def test_passes_that_a_kill_left_of_a_finished_shot_are_removed(self):
        budget = Budget(samples=8)
        run(self.folder, budget)
        command.remove_passes(settings_of(self.folder, budget)[0].files)
        self.assertTrue(command.is_finished(settings_of(self.folder, budget, resume=True), overwrite=False))
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["1.exr", "2.exr", "3.exr"])


class Resuming(Folder):
    def run_until(self, folder, file):
        """Runs the shot in a process of its own and kills it where the file is there. Returns whether it was killed."""
        resume = ["--resume"] if any(folder.glob("*/journal.json")) else []
        words = [sys.executable, "-m", "tests.pipelines.loop.test_shot", str(folder), *resume]
        child = subprocess.Popen(words, cwd=ROOT, stderr=subprocess.PIPE)
        while child.poll() is None and not (file and (folder / file).exists()):
            time.sleep(0.01)
        if child.poll() is None:
            child.kill()
            child.communicate()
            return True
        errors = child.communicate()[1]
        self.assertEqual(child.returncode, 0, errors)
        return False

    def test_killed_in_the_middle_it_resumes_to_the_same_pictures(self):
        whole, broken = self.folder / "whole", self.folder / "broken"
        self.assertFalse(self.run_until(whole, None))
        for moment in ("2.passes/part_0a1.exr", "2.passes/round_0/error_b.exr", f"{NOISY}.passes/part_1a0.exr"):
            self.assertTrue(self.run_until(broken, moment), moment)
        self.assertFalse(self.run_until(broken, None))
        for n in FRAMES:
            a, b = (exr.read(folder / f"{n}.exr") for folder in (whole, broken))
            for name in a:
                np.testing.assert_array_equal(a[name], b[name], f"{n}: {name}")
            parts = [json.loads((f / f"{n}.passes" / "journal.json").read_text())["parts"] for f in (whole, broken)]
            self.assertEqual(*([[part["file"], part["samples"]] for part in half] for half in parts))


class Noise(Folder):
    def test_the_noise_of_a_frame_is_that_of_its_mean(self):
        _, result = run(self.folder, Budget(samples=8))
        loop = ShotFrame(None, Polyrecon(), settings_of(self.folder, Budget(samples=8), resume=True)[1], None)
        loop.audit = result.frames[1][1].audit
        loop.reconstruction = Reconstruction(None, None, loop.folder, loop.state, loop.audit, False)
        a, b = (
            np.mean([exr.read(loop.folder.path / file)["L.Combined.R"] for file in loop.state.files(half)], axis=0)
            for half in HALVES
        )
        expected = float(np.mean((a - b) ** 2 / (a + b) ** 2))
        self.assertTrue(math.isclose(loop.reconstruction.noise(), expected, rel_tol=1e-4))


def main(words):
    run(words[0], Budget(samples=20), resume="--resume" in words, keep_passes=True)


if __name__ == "__main__":
    if len(sys.argv) > 1 and os.path.isabs(sys.argv[1]):
        sys.exit(run_main("shot", main, sys.argv[1:]))
    unittest.main()
