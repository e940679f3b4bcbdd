"""The report about records and messages that someone else wrote."""

import contextlib
import io
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from pipelines.common.errors import DriverError, ExitCode
from pipelines.common.terminal import print_lines
from pipelines.farm import report, slurm, task
from pipelines.farm.job import JOB_FILE, RECORDS, REPORT_FILE, Job

from .shot import make_shot

ROOT = Path(__file__).resolve().parents[3]
POLYRECON = os.path.abspath(os.environ["POLYRECON"])
BEGUN = {"chunk": 0, "frames": "1-2", "node": "node1", "begun": 5.0}
ENDED = {
    **BEGUN,
    "seconds": 2.0,
    "cpu_seconds": 3.0,
    "peak_bytes": 10,
    "bytes_read": 4,
    "bytes_written": 6,
    "exit_code": 4,
    "frame_errors": {"2": "broken"},
    "written": "1",
}
FORGED = "x\nopenjd_fail: forged\ropenjd_env: A=B\x1b]0;title\x07\u2028openjd_status: forged"


class Reports(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.job = Job("in.####.exr", "out.####.exr", [-1, 1, 2], "/polyrecon", ["--quality", "best"])
        (self.folder / RECORDS).mkdir()

    def lines(self, *records, problems=None):
        for number, record in enumerate(records):
            (self.folder / RECORDS / f"{number}.json").write_text(json.dumps(record))
        found = report.summary(self.job, {1}, problems or {}, report.records_of(self.folder))
        with contextlib.redirect_stdout(io.StringIO()) as stdout:
            print_lines(*report.lines_of(found))
        return stdout.getvalue().splitlines()

    def test_small_frames_have_sizes_too(self):
        record = {**ENDED, "bytes_read": 20_400, "bytes_written": 6}
        self.assertIn("a frame read 20.4 kB and wrote 6 bytes", self.lines(record))

    def test_openjd_injection(self):
        """A line of the session begins with openjd_; no name or message of a file can begin one."""
        forged = {**ENDED, "node": FORGED, "frame_errors": {"2": FORGED, "-1": "openjd_fail: forged"}}
        names = {**BEGUN, "node": "openjd_fail: forged", "frames": "1"}
        lines = self.lines(forged, names, {**ENDED, "node": "openjd_fail: forged"}, problems={2: FORGED})
        self.assertEqual([line for line in lines if line.startswith("openjd") or not line.isprintable()], [])
        self.assertTrue(any("x\\nopenjd_fail: forged\\ropenjd_env" in line for line in lines), lines)

    def test_quiet_and_verbose(self):
        """-q prints nothing, -v also which frames are finished and how they were checked."""
        make_shot(self.folder / "in", [1, 2, 3])
        shot = ["-i", self.folder / "in/shot.####.exr", "-o", self.folder / "out/shot.####.exr"]
        command = [sys.executable, ROOT / "pipelines/farm/farm.py", "report", *shot, "--frames", "1-3"]
        said = {}
        for words in ((), ("-q",), ("-v",)):
            done = subprocess.run([*command, "--polyrecon", POLYRECON, *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, 4, done.stderr)
            self.assertIn("polyrecon-farm: not finished: 1-3", done.stderr)
            said[words] = done.stdout.splitlines()
        self.assertEqual(said[("-q",)], [])
        self.assertEqual(
            said[()], ["0 of 3 frames are finished", "not finished: 1-3; submitting again denoises what is missing"]
        )
        self.assertEqual(said[("-v",)][:3], [*said[()], "finished: none"])
        self.assertRegex(said[("-v",)][3], "checked by: .*polyrecon denoise -i ")

    def test_records_that_are_none_are_left_out(self):
        wrong = [None, [], {}, {"begun": 1}, {**BEGUN, "begun": "x"}, {**ENDED, "written": "x"}, {**ENDED, "more": 1}]
        wrong += [{**ENDED, "frame_errors": {"x": "y"}}, {**ENDED, "node": 7}, {**ENDED, "seconds": float("nan")}]
        lines = self.lines(ENDED, *wrong, BEGUN)
        self.assertIn("node node1: 1 frame by 1 task, 2 s (3 s of processors), 1800 frames an hour and task", lines)
        self.assertIn("no end, the node died or still works on it: node1: 1-2", lines)
        (self.folder / RECORDS / "x.json").write_bytes(b"[" * 100000)
        os.mkfifo(self.folder / RECORDS / "y.json")
        self.assertEqual(len(report.records_of(self.folder)), 2)

    def test_a_page_shows_finished_frames(self):
        make_shot(self.folder, [1, 2])
        job = Job(str(self.folder / "shot.####.exr"), str(self.folder / "out.####.exr"), [1, 2, 3], POLYRECON, [])
        subprocess.run(job.words([1, 2]), check=True, capture_output=True)
        page = self.folder / "page.html"
        with contextlib.redirect_stdout(io.StringIO()), self.assertRaises(DriverError):
            report.make_report(job, self.folder, 1, False, page)
        text = page.read_text(encoding="utf-8")
        scene = json.loads(re.search('<script type="application/json" id="scene">(.*)</script>', text)[1])
        self.assertEqual(scene["frames"], ["1", "2"])
        self.assertEqual([image["name"] for image in scene["images"]], ["input", "result"])
        self.assertEqual([layer["window"][2:] for layer in scene["layers"]], [[32, 18]] * 4)
        self.assertIn("<li>2 of 3 frames are finished</li>", text)

    def test_jobs_that_are_edited_are_refused(self):
        self.job.save(self.folder)
        self.assertEqual(Job.load(self.folder), self.job)
        content = json.loads((self.folder / JOB_FILE).read_text())
        for name, value in (
            *((name, None) for name in content),
            ("frames", ["1"]),
            ("frames", []),
            ("frames", "1-2"),
            ("chunk", 0),
            ("threads", -1),
            ("memory", 1e99),
            ("options", [1]),
            ("options", ["--aov", "a\0b"]),
            ("input", "in\0.####.exr"),
            ("input", "in.exr"),
            ("output", "out.exr"),
            ("more", 1),
        ):
            (self.folder / JOB_FILE).write_text(json.dumps({**content, name: value}))
            with self.assertRaisesRegex(DriverError, "job.json: is not the description of a job") as caught:
                Job.load(self.folder)
            self.assertEqual(caught.exception.code, ExitCode.BAD_INPUT)
        (self.folder / JOB_FILE).unlink()
        with self.assertRaisesRegex(DriverError, "job.json: No such file") as caught:
            Job.load(self.folder)
        self.assertEqual(caught.exception.code, ExitCode.MISSING)

    def test_the_report_of_a_job_that_is_none(self):
        """After --wait, report and log are those of a folder into which others can write."""
        log, said = self.folder / slurm.REPORT_LOG, []
        log.write_bytes(b"a \xff line\nand one more\n")
        for content in (b"", b"[]", b"{}", b'{"unfinished": 1}', b'{"unfinished": "\\u0000"}', b"\xff", b"[" * 100000):
            (self.folder / REPORT_FILE).write_bytes(content)
            with self.assertRaisesRegex(DriverError, "job 7 ended without a report"):
                slurm.say_report(self.folder, "7", lambda *lines: said.extend(lines))
        (self.folder / REPORT_FILE).write_text('{"unfinished": "1-2"}')
        with self.assertRaisesRegex(DriverError, "not finished: 1-2"):
            slurm.say_report(self.folder, "7", lambda *lines: said.extend(lines))
        self.assertEqual(said, ["a \ufffd line", "and one more"])
        log.unlink()
        os.mkfifo(log)
        with self.assertRaisesRegex(DriverError, "is not a regular file"):
            slurm.say_report(self.folder, "7", print)

    def test_links_at_the_names_of_logs_are_refused(self):
        victim, folder = self.folder / "victim", self.folder / "job"
        victim.write_text("precious")
        slurm.make_folder(folder, self.job)
        for plant in (os.symlink, os.link):
            plant(victim, folder / "log.0.txt")
            with self.assertRaisesRegex(DriverError, "log.0.txt: is a link"):
                slurm.make_folder(folder, self.job)
            (folder / "log.0.txt").unlink()
        slurm.make_folder(folder, self.job)
        self.assertEqual(victim.read_text(), "precious")

    def test_numbers_of_chunks_that_are_none(self):
        self.job.save(self.folder)
        for index in ("x", "", "-1", "1.5", "9" * 5000, "7"):
            with contextlib.redirect_stderr(io.StringIO()) as stderr, contextlib.suppress(SystemExit):
                self.assertEqual(task.main([str(self.folder), f"{index}"]), ExitCode.USAGE)
            self.assertEqual(len(stderr.getvalue().splitlines()), 1, index)

    def test_a_frame_of_a_stranger(self):
        """The program's message about a broken frame holds the frame's path."""
        shot = self.folder / "a\nopenjd_fail: b\x1b[31m"
        shot.mkdir()
        make_shot(shot, [1, 2])
        (shot / "shot.0002.exr").write_bytes(b"no frame")
        words = ["-i", shot / "shot.####.exr", "-o", self.folder / "shot.####.exr", "--frames", "1-2"]
        command = [sys.executable, ROOT / "pipelines/farm/report.py", *words, "--polyrecon", POLYRECON]
        done = subprocess.run([*map(str, command), "--progress", "openjd"], capture_output=True, text=True)
        self.assertEqual(done.returncode, ExitCode.MISSING, done.stderr)
        lines = [line for line in done.stdout.splitlines() if line.startswith("openjd_fail")]
        self.assertEqual(lines, ["openjd_fail: not finished: 1,2"])
        self.assertNotIn("\x1b", done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
