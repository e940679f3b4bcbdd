import dataclasses
import json
import math
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

from pipelines.common import exr
from pipelines.common.errors import DriverError, ExitCode
from pipelines.loop import budget
from pipelines.loop.budget import Budget
from pipelines.loop.folder import PassFolder
from pipelines.loop.reconstruction import Reconstruction
from pipelines.loop.renderer import SAMPLE_COUNT
from tests.pipelines.loop.synthetic import SyntheticRenderer, loop

ROOT = Path(__file__).resolve().parents[3]


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


def counts_of(result, half=None):
    parts = [part for part in result.state.parts if half in (None, part.half)]
    return sum(exr.read(result.merged.parent / part.file)[f"L.{SAMPLE_COUNT}"] for part in parts)


class Statistics(Folder):
    """One run of a large frame stands for many runs of a tiny one: its pixels are independent."""

    def test_the_mean_is_unbiased_and_its_variance_right(self):
        renderer, result = loop(self.folder, Budget(samples=32), width=192, height=128)
        merged = exr.read(result.merged)
        counts = counts_of(result)
        self.assertGreater(counts[:, :96].mean(), 3 * counts[:, 96:].mean())
        error = merged["L.Combined.R"] - renderer.mean
        # The true variance of (A + B) / 2, from the counts of each half.
        variance = renderer.mean**2 * renderer.spread * sum(1 / counts_of(result, half) for half in "ab") / 4
        for name, place in {"all": np.s_[:], "noisy": np.s_[:, :96], "clean": np.s_[:, 96:]}.items():
            z = (error / np.sqrt(variance))[place]
            self.assertLess(abs(z.mean()) * math.sqrt(z.size), 4, f"{name}: the mean is {z.mean():.4f} sigma off")
            self.assertLess(abs((z**2).mean() - 1), 0.08, f"{name}: variance {(z**2).mean():.3f} of what is expected")
            estimated = merged["L.Combined Variance.R"][place].mean() / variance[place].mean()
            self.assertLess(
                abs(estimated - 1), 0.1, f"{name}: the estimated variance is {estimated:.3f} of the true one"
            )
        self.assertTrue(np.allclose(merged[f"L.{SAMPLE_COUNT}"], counts))

    def test_judging_a_half_by_itself_would_be_biased(self):
        """Why there are two halves: if pixels that are bright by chance get more samples, the picture is too dark."""
        renderer = SyntheticRenderer(width=192, height=128)
        first = sum(renderer.sample(n) for n in range(4)) / 4
        more = np.where(first > renderer.mean, 16, 0)
        later = sum(renderer.sample(n) for n in range(4, 20)) / 16
        judged_by_itself = np.where(more, (4 * first + 16 * later) / 20, first)
        other = np.roll(more, 7, axis=0)  # Decided by other pixels' samples
        crossed = np.where(other, (4 * first + 16 * later) / 20, first)
        self.assertLess(judged_by_itself.mean() / renderer.mean.mean(), 0.9)
        self.assertAlmostEqual(crossed.mean() / renderer.mean.mean(), 1, delta=0.03)

    def test_samples_follow_noise_and_cost(self):
        _, result = loop(self.folder, Budget(target=1e-6), max_rounds=1)
        counts = counts_of(result) - 8  # those after the first pass
        noisy, clean = counts[:, 4:44], counts[:, 52:]
        self.assertGreater(noisy.mean(), 4 * clean.mean())
        # The lower half costs three times as much. That does not matter where samples are the budget.
        self.assertGreater(noisy[4:28].mean(), 1.3 * noisy[36:60].mean())
        _, result = loop(self.folder / "samples", Budget(samples=32))
        noisy = counts_of(result)[:, 4:44]
        self.assertLess(noisy[4:28].mean(), 1.3 * noisy[36:60].mean())

    def test_where_no_map_pays_the_samples_are_uniform(self):
        even = SyntheticRenderer()
        even.spread = np.full(even.mean.shape, 4.0)
        even.seconds = np.ones(even.mean.shape)
        _, result = loop(self.folder, Budget(target=1e-6), max_rounds=1, renderer=even)
        counts = counts_of(result)
        self.assertEqual(counts.min(), counts.max())
        self.assertGreater(counts.min(), 8)


class Budgets(Folder):
    def test_a_budget_of_samples_is_not_exceeded(self):
        _, result = loop(self.folder, Budget(samples=24))
        self.assertLessEqual(result.samples, 24 * 1.02)
        self.assertGreater(result.samples, 18)
        self.assertEqual(result.why_ended, "the samples are spent")

    def test_no_number_of_the_sequence_is_used_twice(self):
        renderer, _ = loop(self.folder, Budget(samples=32))
        ranges = sorted(renderer.ranges)
        for (first, length), (following, _) in zip(ranges, ranges[1:]):
            self.assertLessEqual(first + length, following)

    def test_a_renderer_that_takes_numbers_of_the_other_half_is_refused(self):
        for method in ("uniform", "extra"):
            with self.subTest(method), self.assertRaisesRegex(DriverError, "took .* samples of a pixel") as caught:
                loop(self.folder / method, Budget(samples=16), renderer=Greedy(method))
            self.assertEqual(caught.exception.code, ExitCode.RENDERER)

    def test_a_half_without_samples_has_no_part_in_that_round(self):
        counts = {"a": np.zeros((64, 96), int), "b": np.repeat([[4, 0]], 48, axis=1) * np.ones((64, 1), int)}
        decided = unittest.mock.patch.object(Reconstruction, "sample_counts", return_value=counts)
        with decided, unittest.mock.patch("pipelines.loop.frame.map_pays", return_value=True):
            _, result = loop(self.folder, Budget(samples=64), max_rounds=1)
        parts = [part for part in result.state.parts if part.round == 1]
        self.assertEqual([(part.half, part.samples) for part in parts], [("b", 2)])
        self.assertEqual(result.samples, 10)
        self.assertTrue(np.isfinite(exr.read(self.folder / "out.exr")["L.Combined.R"]).all())

    def test_a_target_ends_the_loop(self):
        _, result = loop(self.folder, Budget(target=1.0))
        self.assertEqual(len(result.state.rounds), 1)
        self.assertIn("target", result.why_ended)

    def test_a_budget_of_seconds_is_exceeded_by_one_pass_at_most(self):
        # With the usual share, decisions would not pay in so few seconds.
        with unittest.mock.patch.object(budget, "MAX_DECISION_SHARE", 100.0):
            _, result = loop(self.folder, Budget(seconds=10), max_rounds=100)
        self.assertEqual(result.why_ended, "the seconds are spent")
        passes = [part.seconds for part in result.state.parts]
        rounds = result.state.rounds
        # The loop may exceed its seconds by one pass, and the last reconstruction takes no longer than its reserve.
        self.assertLess(result.seconds, 10 + max(passes) + 4 * rounds[-1].decision_seconds)
        self.assertLess(rounds[-1].seconds, 10)

    def test_few_seconds_are_spent_on_uniform_samples(self):
        with unittest.mock.patch.object(budget, "MAX_DECISION_SHARE", 1e-6):
            _, result = loop(self.folder, Budget(seconds=10))
        self.assertIn("too few of them to judge", result.why_ended)
        self.assertEqual(result.state.rounds, [])
        self.assertFalse(any(part.masked for part in result.state.parts))
        self.assertGreater(result.samples, 8)
        self.assertEqual([part.samples for part in result.state.parts if part.round == 0][:2], [4, 4])
        self.assertTrue(np.isfinite(result.error))
        self.assertEqual(list(self.folder.rglob("merged_*.exr")), [])
        for half in "ab":
            samples = sum(part.samples for part in result.state.parts if part.half == half)
            self.assertEqual(samples, result.samples / 2)

    def test_a_first_pass_of_more_than_its_share_is_judged_all_the_same(self):
        """Its halves have a part each, and between two parts alone variance is measured."""
        with unittest.mock.patch.multiple(budget, MAX_DECISION_SHARE=100.0, UNIFORM_SHARE=0.0):
            _, result = loop(self.folder, Budget(seconds=60), max_rounds=1)
        self.assertEqual([part.round for part in result.state.parts][:4], [0, 0, 0, 0])
        self.assertEqual(result.state.rounds[0].samples, sum(part.samples for part in result.state.parts[:4]))

    def test_a_first_pass_that_takes_all_seconds_is_the_result(self):
        _, result = loop(self.folder, Budget(seconds=1), renderer=SlowFirstPass(seconds=1))
        self.assertEqual(result.samples, 8)
        self.assertIn("too few of them to judge", result.why_ended)
        self.assertTrue(np.isfinite(exr.read(self.folder / "out.exr")["L.Combined.R"]).all())

    def test_a_budget_of_seconds_continues_as_one_of_samples(self):
        loop(self.folder, Budget(seconds=1), renderer=SlowFirstPass(seconds=1))
        _, result = loop(self.folder, Budget(samples=24), resume=True)
        self.assertEqual(result.why_ended, "the samples are spent")
        self.assertGreater(result.samples, 18)
        self.assertGreater(len(result.state.rounds), 0)

    def test_features_that_are_rendered_once_do_not_count_as_decision_time(self):
        _, result = loop(self.folder, Budget(samples=16), renderer=SlowFeatures())
        self.assertLess(result.state.rounds[0].decision_seconds, SlowFeatures.seconds_once)


class SlowFirstPass(SyntheticRenderer):
    def __init__(self, seconds):
        super().__init__()
        self.seconds_of_part = seconds

    def uniform(self, first, samples, target):
        time.sleep(self.seconds_of_part)
        super().uniform(first, samples, target)


class SlowFeatures(SyntheticRenderer):
    seconds_once = 4.0
    done = False

    def complete(self, merged):
        if not self.done:
            time.sleep(self.seconds_once)
        self.done = True


class Greedy(SyntheticRenderer):
    """Takes a sample more than it may."""

    def __init__(self, method):
        super().__init__()
        self.method = method

    def uniform(self, first, samples, target):
        super().extra(first, np.full(self.mean.shape, samples + (self.method == "uniform")), target)

    def extra(self, first, counts, target):
        super().extra(first, counts + (self.method == "extra"), target)


class NoInputs(SyntheticRenderer):
    def begin(self, frame):
        return dataclasses.replace(super().begin(frame), inputs={})


class Failing(SyntheticRenderer):
    def extra(self, first, counts, target):
        raise DriverError(ExitCode.RENDERER, "it died")


class Noiseless(SyntheticRenderer):
    def sample(self, number):
        return self.mean


class HardFrames(Folder):
    def run_with(self, renderer=None, **arrays):
        """Runs the loop with other arrays of the synthetic frame, `mean` or `spread`."""
        renderer = renderer or SyntheticRenderer()
        for name, values in arrays.items():
            setattr(renderer, name, values)
        _, result = loop(self.folder, Budget(samples=24), renderer=renderer)
        self.assertTrue(
            all(np.isfinite(p).all() for p in exr.read(self.folder / "out.exr", lambda n: ".Combined." in n).values())
        )
        return result

    def test_case34_a_frame_without_noise_ends_at_once_and_says_why(self):
        result = self.run_with(Noiseless())
        self.assertEqual(result.why_ended, "no error is left that more samples could lower")
        self.assertEqual(result.samples, 8)

    def test_case34_one_noisy_spot_draws_the_samples(self):
        spread = np.full((64, 96), 1e-12)
        spread[20:24, 30:34] = 1
        counts = counts_of(self.run_with(spread=spread))
        self.assertGreater(counts[20:24, 30:34].mean(), 4 * counts[44:, 60:].mean())

    def test_case34_pixels_that_are_no_numbers_stop_nothing(self):
        mean = SyntheticRenderer().mean
        mean[30:33, 10:13] = np.nan
        mean[5, 80] = np.inf
        result = self.run_with(mean=mean)
        self.assertEqual(result.why_ended, "the samples are spent")
        self.assertGreater(result.samples, 18)


class Resuming(Folder):
    def run_killed(self, folder, seconds):
        """Starts the loop and kills it after some seconds. Returns whether it had ended by itself."""
        resume = ["--resume"] if (folder / "passes" / "journal.json").exists() else []
        words = [sys.executable, "-m", "tests.pipelines.loop.synthetic", str(folder), "24", *resume]
        child = subprocess.Popen(words, cwd=ROOT, start_new_session=True, stderr=subprocess.PIPE)
        try:
            errors = child.communicate(timeout=seconds)[1]
            self.assertEqual(child.returncode, 0, errors)
            return True
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.communicate()
            return False

    def test_case32_killed_at_any_moment_it_resumes_to_the_same_picture(self):
        whole, broken = self.folder / "whole", self.folder / "broken ä #{"
        whole.mkdir()
        broken.mkdir()
        start = time.monotonic()
        self.assertTrue(self.run_killed(whole, 300))
        seconds = time.monotonic() - start  # The moments of the kills follow the speed of the machine.
        seed = random.randrange(1 << 30)
        moments, ended, runs = random.Random(seed), False, 0
        while not ended and runs < 15:
            ended = self.run_killed(broken, seconds * moments.uniform(0.2, 0.6) * 1.3**runs)
            runs += 1
        self.assertTrue(ended, f"seed {seed}: never ended")
        self.assertGreater(runs, 1, f"seed {seed}: never killed")
        for name in ("out.exr", "passes/merged.exr"):
            a, b = exr.read(whole / name), exr.read(broken / name)
            for channel in a:
                np.testing.assert_array_equal(a[channel], b[channel], f"seed {seed}, {runs} runs: {name} {channel}")
        parts = json.loads((broken / "passes" / "journal.json").read_text())["parts"]
        self.assertEqual(len({part["first_sample"] for part in parts}), len(parts))

    def test_a_larger_budget_continues(self):
        _, small = loop(self.folder, Budget(samples=16))
        _, large = loop(self.folder, Budget(samples=32), resume=True)
        before, after = small.state.parts, large.state.parts
        self.assertEqual(after[: len(before)], before)
        self.assertGreater(large.samples, small.samples + 8)

    def test_case31_a_loop_that_fails_leaves_the_result_before_it(self):
        loop(self.folder, Budget(samples=8))
        before = {name: (self.folder / name).read_bytes() for name in ("out.exr", "passes/merged.exr")}
        with self.assertRaisesRegex(DriverError, "it died"):
            loop(self.folder, Budget(samples=24), resume=True, renderer=Failing())
        self.assertEqual(before, {name: (self.folder / name).read_bytes() for name in before})

    def test_a_scene_that_changed_is_not_continued(self):
        """If a renderer lists no inputs, the scene's file is compared."""
        scene = self.folder / "scene"
        scene.write_text("one")
        loop(self.folder, Budget(samples=8), renderer=NoInputs(), scene=scene)
        scene.write_text("two")
        with self.assertRaisesRegex(DriverError, "scene is not what it was") as caught:
            loop(self.folder, Budget(samples=8), resume=True, renderer=NoInputs(), scene=scene)
        self.assertEqual(caught.exception.code, ExitCode.USAGE)
        scene.write_text("one")
        loop(self.folder, Budget(samples=8), resume=True, renderer=NoInputs(), scene=scene)

    def test_two_drivers_in_one_folder(self):
        refused = self.assertRaisesRegex(DriverError, f"process {os.getpid()} on .* works in it")
        with PassFolder(self.folder / "passes").claimed(), refused as caught:
            loop(self.folder, Budget(samples=8))
        self.assertEqual(caught.exception.code, ExitCode.USAGE)
        self.assertEqual(os.listdir(self.folder / "passes"), ["polyrecon.lock"])

    def test_passes_are_not_overwritten_unasked(self):
        loop(self.folder, Budget(samples=8))
        with self.assertRaisesRegex(DriverError, "journal.json: .*--resume") as caught:
            loop(self.folder, Budget(samples=8))
        self.assertEqual(caught.exception.code, ExitCode.USAGE)


if __name__ == "__main__":
    unittest.main()
