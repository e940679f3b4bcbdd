import contextlib
import io
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

from pipelines.common import process
from pipelines.common.errors import DriverError, ExitCode, run_main
from pipelines.common.polyrecon_cli import Polyrecon, find_polyrecon


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"


class Processes(unittest.TestCase):
    def test_awkward_words_arrive_as_they_are(self):
        words = ["a b", "-x", "'\"", "#{}$(touch no)", "ä;日"]
        code, output, _ = process.run([sys.executable, "-c", "import sys; print(sys.argv[1:])", "--", *words])
        self.assertEqual((code, output.strip()), (0, repr(["--", *words])))

    def test_a_time_limit_ends_the_child_and_its_children(self):
        with tempfile.TemporaryDirectory() as folder:
            pid_file = Path(folder, "pid")
            script = f"sleep 100 & echo $! > {pid_file}; trap '' TERM; wait; sleep 100"
            grace, process.GRACE_SECONDS = process.GRACE_SECONDS, 0.2
            try:
                with self.assertRaises(subprocess.TimeoutExpired):
                    process.run(["sh", "-c", script], timeout=0.5)
            finally:
                process.GRACE_SECONDS = grace
            time.sleep(0.1)
            self.assertFalse(alive(int(pid_file.read_text())))

    def test_a_carriage_return_does_not_end_a_line(self):
        _, output, _ = process.run(["printf", "one\\r two\\302\\205\\nthree\\n"])
        self.assertEqual(process.lines_of(output), ["one\r two\x85", "three"])


class Polyrecons(unittest.TestCase):
    def test_it_is_found_and_runs(self):
        self.assertIn("denoise", Polyrecon().run("--help"))

    def test_a_name_is_looked_for_on_the_path(self):
        program = find_polyrecon()
        with mock.patch.dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}"):
            self.assertEqual(find_polyrecon(program.name), program)
        with self.assertRaisesRegex(DriverError, "no-such-polyrecon: no such program"):
            find_polyrecon("no-such-polyrecon")

    def test_a_wrong_place_is_named(self):
        with self.assertRaisesRegex(DriverError, "/no/such: no such program") as caught:
            find_polyrecon("/no/such")
        self.assertEqual(caught.exception.code, ExitCode.MISSING)

    def test_a_reader_that_ends_is_no_traceback(self):
        command = f"{sys.executable} pipelines/farm/cost.py | true; exit ${{PIPESTATUS[0]}}"
        done = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
        self.assertIn(done.returncode, (ExitCode.DONE, ExitCode.OUTPUT))
        self.assertIn(done.stderr, ("", "polyrecon-farm: Broken pipe\n"))

    def test_a_failure_keeps_code_and_line(self):
        with self.assertRaisesRegex(DriverError, "polyrecon inspect: .*missing.exr") as caught:
            Polyrecon().run("inspect", "/missing.exr")
        self.assertEqual(caught.exception.code, ExitCode.MISSING)


class Mains(unittest.TestCase):
    def test_codes(self):
        def fail(_):
            raise DriverError(ExitCode.RENDERER, "it died")

        def terminated(_):
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(1)

        def internal(_):
            return 1 // 0

        def full(_):
            raise OSError(28, "No space left on device", "a\x1b[31m\nb")

        def no_descriptor(_):
            raise OSError(24, "Too many open files")

        before = signal.getsignal(signal.SIGTERM)
        try:
            for main, code, line in (
                (internal, 1, r"test: internal error: ZeroDivisionError: .*\(test_process.py:\d+\)\n"),
                (full, 5, r"test: a\\x1b\[31m\\nb: No space left on device\n"),
                (no_descriptor, 33, "test: Too many open files: raise `ulimit -n`\n"),
            ):
                with contextlib.redirect_stderr(io.StringIO()) as stderr:
                    self.assertEqual(run_main("test", main), code)
                self.assertRegex(stderr.getvalue(), f"^{line}$")
            self.assertEqual(run_main("test", lambda _: None), 0)
            self.assertEqual(run_main("test", fail), 7)
            self.assertEqual(run_main("test", terminated), 143)
        finally:
            signal.signal(signal.SIGTERM, before)


if __name__ == "__main__":
    unittest.main()
