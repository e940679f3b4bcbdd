import argparse
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from pipelines.common.denoise_defaults import QUALITIES
from pipelines.common.errors import DriverError, ExitCode
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.farm.requirements import MODEL_FILE, Frame, Model, Node, chunk_for, frame_of, threads_for
from pipelines.farm.submission import first_frame, request_of

from .shot import make_shot

ROOT = Path(__file__).resolve().parents[3]
POLYRECON = os.path.abspath(os.environ["POLYRECON"])
GB = 10**9


class Threads(unittest.TestCase):
    def test_memory_and_processors_run_out_together(self):
        node = Node(64, 256 * GB)
        self.assertEqual(threads_for(4 * GB, [node]), 1)  # 64 tasks fit
        self.assertEqual(threads_for(8 * GB, [node]), 2)  # 32 fit
        self.assertEqual(threads_for(100 * GB, [node]), 32)
        self.assertEqual(threads_for(256 * GB, [node]), 64)

    def test_a_frame_for_which_no_node_is_large_enough(self):
        with self.assertRaises(DriverError) as caught:
            threads_for(9 * GB, [Node(4, 8 * GB), Node(64, 0)])
        self.assertEqual(caught.exception.code, ExitCode.MEMORY)
        self.assertEqual(threads_for(9 * GB, [Node(64, 0)]), 1)  # The cluster does not report memory.

    def test_chunks_fill_the_time_and_the_array(self):
        self.assertEqual(chunk_for(60, 10, 1000, 1000), 10)
        self.assertEqual(chunk_for(6000, 10, 100, 1000), 1)
        self.assertEqual(chunk_for(0.1, 10, 50, 1000), 50)
        self.assertEqual(chunk_for(6000, 10, 5000, 1000), 5)


class Requirements(unittest.TestCase):
    def test_the_model_holds_for_a_real_run(self):
        """The peak memory of this build is not above the request, and the model is not far above the peak."""
        model = Model()
        sample = Path(os.environ["POLYRECON_SAMPLES"]) / "glass_16.exr"
        frame = frame_of(
            json.loads(subprocess.run([POLYRECON, "inspect", "--json", sample], capture_output=True).stdout)
        )
        # Mean, variance and halves of beauty, normal, albedo, depth and visibility take part in the fit.
        self.assertEqual((frame.width, frame.height), (320, 180))
        self.assertEqual((frame.channels, frame.fit_channels), (58, 4 * (3 + 3 + 3 + 1 + 3)))
        with tempfile.TemporaryDirectory() as folder:
            for k in range(1, 7):  # One frame has all four neighbours and a frame after them.
                os.symlink(sample, f"{folder}/in.{k}.exr")
            words = ["-i", f"{folder}/in.#.exr", "-o", f"{folder}/out.#.exr", "--frames", "1-6"]
            words += ["--quality", "draft", "--threads", "1", "--quiet"]
            child = subprocess.Popen([POLYRECON, "denoise", *words])
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(child.returncode, 0)
        peak = usage.ru_maxrss * 1024
        self.assertLessEqual(peak, model.request_bytes(frame, "draft"))
        self.assertLess(model.peak_bytes(frame, "draft"), 2 * peak)

    def test_larger_asks_for_more(self):
        model, small = Model(), Frame(1920, 1080, 42, 41)
        for quality in QUALITIES:
            self.assertLess(model.peak_bytes(small, quality), model.peak_bytes(Frame(3840, 2160, 42, 41), quality) / 2)
        self.assertLess(model.wall_seconds(small, "standard", 2), model.wall_seconds(small, "standard", 1))

    def test_layers_to_denoise_are_counted_as_the_program_names_them(self):
        sample = Path(os.environ["POLYRECON_SAMPLES"]) / "study_small_0.exr"  # with two light groups
        files = {"input": str(sample.with_name("study_small_#.exr")), "output": "clean.#.exr"}
        options = argparse.Namespace(**files, memory=0, model=None)
        requests = {}
        for words in ((), ("--aov", "Combined_lamp"), ("--aov=all",), ("-l", "Combined_lamp,Combined_daylight")):
            options.options = list(words)
            requests[words] = request_of(options, first_frame(options, [0], Polyrecon(POLYRECON)))
        none, one, both, named = requests.values()
        self.assertLess(none, one)
        self.assertLess(one, both)
        self.assertEqual(both, named)


class FirstFrame(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        make_shot(self.folder, [1, 2, 3])
        broken = self.folder / "shot.0001.exr"
        broken.write_bytes(broken.read_bytes()[:2000])

    def first(self, frames, *words):
        pattern = str(self.folder / "shot.####.exr")
        options = argparse.Namespace(
            input=pattern, output=str(self.folder / "c.####.exr"), options=list(words), memory=0, threads=0, chunk=0
        )
        return first_frame(options, frames, Polyrecon(POLYRECON))

    def test_a_broken_frame_does_not_keep_the_others_from_being_submitted(self):
        self.assertEqual(self.first([0, 1, 2]).width, 64)
        with self.assertRaises(DriverError) as caught:
            self.first([0, 1])
        self.assertEqual(caught.exception.code, ExitCode.BAD_INPUT)
        self.assertIn("shot.0001.exr", str(caught.exception))

    def test_a_layer_that_no_frame_has_is_said_before_anything_is_submitted(self):
        for words in (["--aov", "Combned"], ["--aov=Combned"], ["--map", "albedo=Combned"]):
            with self.assertRaises(DriverError) as caught:
                self.first([1, 2, 3], *words)
            self.assertEqual(caught.exception.code, ExitCode.MISSING)
            self.assertRegex(
                str(caught.exception), "^options of polyrecon denoise: [^:]*shot.0002.exr: no layer Combned"
            )


class Commands(unittest.TestCase):
    def farm(self, *words):
        return subprocess.run(
            [sys.executable, ROOT / "pipelines/farm/farm.py", *map(str, words)], capture_output=True, text=True
        )

    def test_every_command_has_help(self):
        self.assertEqual(self.farm().returncode, 2)
        listed = self.farm("--help").stdout
        for command in ("slurm", "openjd", "report", "cost"):
            self.assertIn(command, listed)
            done = self.farm(command, "--help")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(self.farm("help", command).stdout, done.stdout)

    def test_cost_follows_price_and_frames(self):
        def cost(*words):
            table = self.farm("cost", *words).stdout.splitlines()
            return [float(line.split("|")[-2]) for line in table[2:]]

        once, twice = cost("--frames", "1000", "--price", "10"), cost("--frames", "2000", "--price", "10")
        self.assertEqual(len(once), 3)
        for a, b in zip(once, twice):
            self.assertAlmostEqual(b / a, 2, places=2)
        for a, b in zip(once, cost("--frames", "1000", "--price", "20")):
            self.assertAlmostEqual(b / a, 2, places=2)

    def test_hostile_options_end_with_one_line(self):
        for command, option, value in (
            ("cost", "--speed", "0"),
            ("cost", "--speed", "nan"),
            ("cost", "--size", "0x"),
            ("cost", "--size", "9" * 5000 + "x1"),
            ("cost", "--node-memory", "9" * 400 + "T"),
            ("cost", "--node-cpus", "9" * 30),
            ("cost", "--frames", "9" * 5000),
            ("slurm submit", "--memory", "9" * 400),
            ("slurm submit", "--task-minutes", "inf"),
            ("openjd", "--worker-memory", "9" * 400),
            ("report", "--input", "no_place.exr"),
        ):
            done = self.farm(*command.split(), option, value)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), (option, done.stderr[-300:]))
            self.assertIn(option, done.stderr)

    def test_models_that_are_none_are_refused(self):
        whole = json.loads(MODEL_FILE.read_text())
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "model.json"
            for keys, value in (
                (("memory",), 7),
                (("memory", "base"), 0),
                (("memory", "base"), "155"),
                (("memory", "per_pixel"), 1.0),
                (("memory", "per_pixel", "best"), None),
                (("memory", "per_pixel", "more"), 1.0),
                (("seconds", "start"), 0),
                (("seconds", "per_channel"), float("nan")),
                (("neighbour", "bytes"), []),
                (("parallel_part",), 2),
                (("more",), 1),
            ):
                *parents, last = keys
                document = owner = json.loads(json.dumps(whole))
                for key in parents:
                    owner = owner[key]
                owner[last] = value
                path.write_text(json.dumps(document))
                with self.assertRaisesRegex(DriverError, "is not a file that farm_model.py writes"):
                    Model(path)
            path.unlink()
            os.mkfifo(path)
            with self.assertRaisesRegex(DriverError, "is not a regular file"):
                Model(path)

    def test_report_without_a_job(self):
        with tempfile.TemporaryDirectory() as folder:
            make_shot(folder, [1, 2])
            words = ["-i", f"{folder}/shot.####.exr", "-o", f"{folder}/clean.####.exr"]
            subprocess.run([POLYRECON, "denoise", *words, "--frames", "1", "--quiet"], check=True)
            done = self.farm("report", *words, "--frames", "1-2", "--polyrecon", POLYRECON)
            self.assertEqual(done.returncode, 4)
            self.assertIn(
                "1 of 2 frames are finished\nnot finished: 2; submitting again denoises what is missing\n", done.stdout
            )
            # With other settings frame 1 is not finished.
            done = self.farm("report", *words, "--frames", "1", "--polyrecon", POLYRECON, "--", "--quality", "best")
            self.assertEqual(done.returncode, 4)
