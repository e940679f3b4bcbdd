"""The progress on a terminal, in a log and as JSON."""

import contextlib
import io
import json
import os
import pty
import signal
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

from pipelines.common import progress
from pipelines.common.progress import Progress

ROOT = Path(__file__).resolve().parents[3]
# A driver of two frames, which says a line about each and waits for its end.
DRIVER = """
import sys, time
from pipelines.common.errors import run_main
from pipelines.common.progress import Progress
from pipelines.common.terminal import print_lines
def main(words):
    with Progress("auto", frames=2) as progress:
        for frame in (1, 2):
            progress.begin_frame()
            progress.update("rendering", frame=frame, samples=8, done=0.5)
            time.sleep(0.3)
            print_lines(f"frame {frame} is done")
        time.sleep(float(sys.argv[1]))
sys.exit(run_main("driver", main))
"""


def obey_interrupts():
    """What runs in the background of a shell ignores SIGINT, and so would its children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class OnATerminal(unittest.TestCase):
    def run_driver(self, seconds, interrupt=False, stdout=None):
        """Runs DRIVER with standard error on a terminal; returns (exit code, what the terminal got)."""
        terminal, other = pty.openpty()
        command = [sys.executable, "-B", "-c", DRIVER, str(seconds)]
        child = subprocess.Popen(command, stdout=stdout or other, stderr=other, cwd=ROOT, preexec_fn=obey_interrupts)
        os.close(other)
        shown, interrupted = b"", False
        while True:
            try:
                chunk = os.read(terminal, 4096)
            except OSError:  # the other end is closed
                break
            if not chunk:
                break
            shown += chunk
            if interrupt and not interrupted and b"frame 2 (2 of 2)" in shown:
                child.send_signal(signal.SIGINT)
                interrupted = True
        os.close(terminal)
        return child.wait(20), shown.decode()

    def test_one_bar_for_the_run_and_lines_above_it(self):
        code, shown = self.run_driver(0)
        self.assertEqual(code, 0)
        self.assertIn("frame 1 (1 of 2), rendering, 8 spp", shown)
        self.assertIn(" 25 %", shown)
        self.assertIn(" 75 %", shown)
        self.assertRegex(shown, r"\d:\d\d left")
        self.assertRegex(shown, "(?m)^(.*\x1b\\[2K)?frame 1 is done")

    def test_lines_go_to_the_file_they_are_sent_to(self):
        read, write = os.pipe()
        code, shown = self.run_driver(0, stdout=write)
        os.close(write)
        with open(read) as file:
            self.assertEqual(file.read(), "frame 1 is done\nframe 2 is done\n")
        self.assertEqual(code, 0)
        self.assertNotIn("is done", shown)

    def test_an_interrupt_ends_the_line(self):
        code, shown = self.run_driver(20, interrupt=True)
        self.assertEqual(code, 130)
        self.assertEqual(shown.splitlines()[-1], "driver: interrupted")
        self.assertTrue(shown.endswith("\r\ndriver: interrupted\r\n"), repr(shown[-80:]))


class InALog(unittest.TestCase):
    def lines(self, style, times):
        """What is printed if the progress is updated at these seconds."""
        with contextlib.redirect_stderr(io.StringIO()) as log, mock.patch.object(progress, "time") as clock:
            clock.monotonic.return_value = 0.0
            with Progress(style, frames=2) as shown:
                shown.begin_frame()
                for now in times:
                    clock.monotonic.return_value = now
                    shown.update("round 1", frame=7, samples=12, error=0.01, done=now / 400)
        return log.getvalue().splitlines()

    def test_a_line_a_minute(self):
        self.assertEqual(self.lines("auto", [1, 30, 59]), [])
        found = self.lines("auto", [1, 59, 61, 100, 122])
        self.assertEqual(len(found), 2)
        self.assertEqual(found[1], "frame 7 (1 of 2), round 1, 12 spp, relMSE 0.01, 15 %, 11:18 left")

    def test_json_and_none(self):
        self.assertEqual(self.lines("none", [100]), [])
        found = json.loads(self.lines("json", [100])[0])
        self.assertEqual(found["done"], 0.25)
        self.assertEqual((found["event"], found["phase"], found["frame"]), ("progress", "round 1", 7))


if __name__ == "__main__":
    unittest.main()
