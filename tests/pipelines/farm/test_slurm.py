import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from pipelines.farm.requirements import MIB, Model, frame_of

from .cluster import Cluster, can_run
from .shot import make_shot

ROOT = Path(__file__).resolve().parents[3]
POLYRECON = os.path.abspath(os.environ["POLYRECON"])
FRAMES = range(1, 25)
NODES = ("node1", "node2")
LIMIT_SECONDS = 250


def files_in(folder):
    return {path.name: path.read_bytes() for path in Path(folder).iterdir() if path.is_file() and path.name[0] != "."}


def identities(folder):
    return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in Path(folder).glob("shot.*.exr")}


class DryRun(unittest.TestCase):
    """Without Slurm."""

    def submit(self, folder, *more, path="/nowhere"):
        make_shot(folder, [1, 2])
        command = [sys.executable, ROOT / "pipelines/farm/slurm.py", "submit", "-i", f"{folder}/shot.####.exr"]
        command += ["-o", f"{folder}/new/shot.####.exr", "--frames", "1-2", "--polyrecon", POLYRECON, *more]
        return subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PATH": path})

    def test_it_works_where_there_is_no_slurm(self):
        with tempfile.TemporaryDirectory() as folder:
            done = self.submit(folder, "--dry-run")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"({POLYRECON})", done.stdout)
            self.assertIn("no Slurm answers here", done.stdout)
            self.assertRegex(done.stdout, "sbatch .*--array=0-0 .*--cpus-per-task=1 --mem=[0-9]+M")
            self.assertEqual(sorted(os.listdir(folder)), ["shot.0001.exr", "shot.0002.exr"])
            # Slurm's commands are there, and no controller.
            done = self.submit(folder, "--dry-run", path=os.environ["PATH"])
            self.assertIn("no Slurm answers here", done.stdout, done.stderr)
            done = self.submit(folder)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (4, 1), done.stderr)

    def test_options_are_checked_before_anything_is_submitted(self):
        with tempfile.TemporaryDirectory() as folder:
            done = self.submit(folder, "--dry-run", "--", "--qualty", "best")
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
            self.assertIn("--qualty", done.stderr)


@unittest.skipUnless(can_run(), "starting Slurm needs root and process namespaces")
class Slurm(unittest.TestCase):
    """A cluster of two nodes and a shot in a folder with an awkward name (case 33), for all tests."""

    @classmethod
    def setUpClass(cls):
        cls.cluster = cls.enterClassContext(Cluster(NODES, 2000, gpu_node="node2"))
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="-a 'b' \"{c}\" ä日;")))
        (cls.folder / "in").mkdir()
        (cls.folder / "local").mkdir()
        make_shot(cls.folder / "in", FRAMES)
        cls.words = ["-i", cls.folder / "in/shot.####.exr", "--frames", "1-24"]
        subprocess.run(
            [POLYRECON, "denoise", *cls.words, "-o", cls.folder / "local/shot.####.exr", "--quiet"], check=True
        )

    @classmethod
    def enterClassContext(cls, context):  # noqa: N802 (for Python before 3.11)
        entered = context.__enter__()
        cls.addClassCleanup(context.__exit__, None, None, None)
        return entered

    def setUp(self):
        self.cluster.wait_idle()
        self.out = Path(tempfile.mkdtemp(dir=self.folder))

    def submit(self, *more, folder=None, words=None):
        words = words or [*self.words, "-o", self.out / "shot.####.exr"]
        command = [sys.executable, ROOT / "pipelines/farm/slurm.py", "submit", *words, "--polyrecon", POLYRECON]
        command += ["--folder", folder or self.out / "job", *more]
        return subprocess.Popen(
            [str(word) for word in command],
            env=self.cluster.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def finish(self, process):
        """Waits for the end; returns (exit code, output)."""
        try:
            output, errors = process.communicate(timeout=LIMIT_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            self.fail(f"not finished: {self.cluster.run('squeue')} {process.communicate()}")
        return process.returncode, output + errors

    def report(self):
        return json.loads((self.out / "job" / "report.json").read_text())

    def kill_in_the_middle(self, running, node):
        """Kills the node while it works on a chunk with a finished and an unfinished frame; returns its frames."""
        end = time.monotonic() + LIMIT_SECONDS
        while time.monotonic() < end and running.poll() is None:
            for path in (self.out / "job/records").glob("[0-9]*.json"):
                record = json.loads(path.read_text())
                first = int(record["frames"].split("-")[0])
                done = [(self.out / f"shot.{frame:04d}.exr").exists() for frame in (first, first + 2)]
                if record["node"] == node and "exit_code" not in record and done == [True, False]:
                    self.cluster.kill(node)
                    return record["frames"]
            time.sleep(0.005)
        raise self.failureException(f"{node} never worked: {self.cluster.run('squeue')} {self.finish(running)}")

    def test_case_13_two_nodes_on_one_frame(self):
        words = ["-i", self.folder / "in/shot.####.exr", "-o", self.out / "shot.####.exr", "--frames", "1-4"]
        both = [self.submit("--wait", "--chunk", "4", folder=self.out / job, words=words) for job in ("job", "other")]
        for running in both:
            code, output = self.finish(running)
            self.assertEqual(code, 0, output)
        local = files_in(self.folder / "local")
        self.assertEqual(files_in(self.out), {name: local[name] for name in sorted(local)[:4]})
        records = [json.loads(path.read_text()) for path in self.out.glob("*/records/*.json")]
        self.assertEqual(sorted(record["node"] for record in records), sorted(NODES))

    def test_case_14_finished_frames_stay_and_broken_ones_are_named(self):
        for path in sorted((self.folder / "local").iterdir())[:22]:
            shutil.copy2(path, self.out)
        cut = self.out / "shot.0003.exr"
        cut.write_bytes(cut.read_bytes()[:-1])
        before = identities(self.out)
        broken = self.folder / "in/shot.0028.exr"  # no neighbour of the complete frames
        broken.write_bytes((self.folder / "in/shot.0001.exr").read_bytes()[:-1])
        self.addCleanup(broken.unlink)
        words = ["-i", self.folder / "in/shot.####.exr", "-o", self.out / "shot.####.exr", "--frames", "1-24,27-28"]
        code, output = self.finish(self.submit("--wait", "--chunk", "13", words=words))
        self.assertEqual(code, 4, output)
        self.assertEqual(files_in(self.out), files_in(self.folder / "local"))
        after = identities(self.out)
        self.assertEqual(
            {name for name in after if after[name] != before.get(name)},
            {f"shot.{frame:04d}.exr" for frame in (3, 23, 24)},
        )
        found = self.report()
        self.assertEqual((found["finished"], found["unfinished"]), (24, "27,28"))
        self.assertEqual(sorted(found["reasons"]), ["27", "28"])
        self.assertIn("shot.0028.exr", found["reasons"]["28"])
        self.assertEqual(len(found["failed_attempts"]), 1)

    def test_tasks_ask_for_what_the_model_says(self):
        running = self.submit("--dry-run", "--sbatch=--comment=a b", "--", "--quality", "best")
        code, output = self.finish(running)
        self.assertEqual(code, 0, output)
        array = output.splitlines()[2]
        self.assertIn("'--comment=a b'", array)
        self.assertIn("--requeue", array)
        self.assertIn("--cpus-per-task=1", array)
        inspection = json.loads(
            subprocess.run(
                [POLYRECON, "inspect", "--json", self.folder / "in/shot.0001.exr"], capture_output=True
            ).stdout
        )
        request = Model().request_bytes(frame_of(inspection), "best") // MIB
        self.assertIn(f"--mem={request}M", array)
        self.assertFalse((self.out / "job").exists())

    def test_tasks_with_a_graphics_card_run_where_there_is_one(self):
        words = ["-i", self.folder / "in/shot.####.exr", "-o", self.out / "shot.####.exr", "--frames", "1-4"]
        code, output = self.finish(self.submit("--wait", "--chunk", "1", "--gpus", "1", words=words))
        self.assertEqual(code, 0, output)
        self.assertIn("each with 1 thread, 1 graphics card and ", output)
        records = [json.loads(path.read_text()) for path in (self.out / "job/records").glob("*.json")]
        self.assertEqual([record["node"] for record in records], ["node2"] * 4)
        code, output = self.finish(self.submit("--gpus", "2", words=words, folder=self.out / "other"))
        self.assertEqual((code, len(output.splitlines()) - 2), (2, 1), output)

    def test_what_slurm_refuses_is_told_in_one_line(self):
        code, output = self.finish(self.submit("--memory", "1T"))
        self.assertEqual((code, len(output.splitlines())), (33, 1), output)
        code, output = self.finish(self.submit("--partition", "nowhere"))
        self.assertEqual((code, len(output.splitlines())), (2, 1), output)

    def test_slurm_backslash(self):
        """Slurm ends a job whose log has a backslash in its path; renders and results may have one."""
        folder = self.folder / "back\\slash"
        (folder / "in").mkdir(parents=True)
        (folder / "out").mkdir()
        make_shot(folder / "in", [1, 2])
        words = ["-i", folder / "in/shot.####.exr", "-o", folder / "out/shot.####.exr", "--frames", "1-2"]
        code, output = self.finish(self.submit(words=words, folder=folder / "job"))
        self.assertEqual((code, len(output.splitlines())), (2, 1), output)
        self.assertRegex(output, "backslash: name another --folder\n$")
        self.assertFalse((folder / "job").exists())
        code, output = self.finish(self.submit("--wait", words=words))
        self.assertEqual(code, 0, output)
        self.assertEqual(sorted(path.name for path in (folder / "out").iterdir()), ["shot.0001.exr", "shot.0002.exr"])
        self.assertTrue((self.out / "job/log.0.txt").is_file())

    def test_slurm_planted_link(self):
        victim = self.out / "victim"
        for name in ("task", "report", "log.0.txt", "report.txt", "records"):
            victim.write_text("precious")
            job = self.out / f"job {name}"
            job.mkdir()
            (job / name).symlink_to(victim)
            code, output = self.finish(self.submit(folder=job))
            self.assertEqual((code, victim.read_text()), (5, "precious"), output)
            self.assertIn(f"{name}: is a link", output)
            self.assertEqual([path.name for path in job.iterdir()], [name])

    def test_case_35_a_node_dies_in_the_middle(self):
        running = self.submit("--chunk", "3", "--wait")
        self.addCleanup(self.cluster.boot, "node2")
        lost = self.kill_in_the_middle(running, "node2")
        code, output = self.finish(running)
        self.assertEqual(code, 0, output)
        self.assertEqual(files_in(self.out), files_in(self.folder / "local"))
        found = self.report()
        self.assertEqual((found["finished"], found["unfinished"]), (24, ""))
        self.assertEqual(found["attempts_without_end"], [f"node2: {lost}"])
        self.assertEqual(found["attempts"], 9)
        # Frames that the dead node had written are not written again.
        self.assertLess(found["nodes"]["node1"]["frames"], 24)
        self.assertIn("24 of 24 frames are finished", output)
