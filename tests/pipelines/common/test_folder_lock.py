import json
import os
import socket
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

from pipelines.common.errors import DriverError, ExitCode
from pipelines.common.folder_lock import LOCK, claimed

ROOT = Path(__file__).resolve().parents[3]
HOLD = (
    "import sys; from pipelines.common.folder_lock import claimed\n"
    "with claimed(sys.argv[1]): print(1, flush=1); input()"
)

HOLD_MANY = """
import contextlib, resource, sys
from pipelines.common import folder_lock
from pipelines.common.errors import run_main

def main(words):
    resource.setrlimit(resource.RLIMIT_NOFILE, (64, int(words[1])))
    folder_lock.allow_many(100)
    with contextlib.ExitStack() as folders:
        for number in range(100):
            folders.enter_context(folder_lock.claimed(f"{words[0]}/{number}"))

sys.exit(run_main("test", main, sys.argv[1:]))
"""


class OwnFolders(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name) / "a" / "passes ä"

    def refused(self, line, code=ExitCode.USAGE):
        with self.assertRaisesRegex(DriverError, line) as caught, claimed(self.folder):
            self.fail("it was claimed")
        self.assertEqual(caught.exception.code, code)
        self.assertIn(str(self.folder), str(caught.exception))

    def hold(self):
        """Claims the folder in another process."""
        words = [sys.executable, "-c", HOLD, self.folder]
        child = subprocess.Popen(words, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.addCleanup(child.communicate)
        self.addCleanup(child.kill)
        self.assertEqual(child.stdout.readline(), b"1\n")
        return child

    def test_a_folder_is_claimed_again_and_again(self):
        for _ in range(2):
            with claimed(self.folder):
                holder = json.loads((self.folder / LOCK).read_text())
                self.assertEqual(holder, {"host": socket.gethostname(), "pid": os.getpid()})
                self.refused(f"process {os.getpid()} on {socket.gethostname()} works in it: wait for its end")
            self.assertEqual((self.folder / LOCK).read_text(), "")
            (self.folder / "part.exr").touch()

    def test_passes_dir_of_the_user_is_refused(self):
        for name in (".my_backup.exr", "sub"):
            self.folder.mkdir(parents=True)
            (self.folder / name).mkdir()
            self.refused("is not empty and holds no passes")
            self.assertEqual([path.name for path in self.folder.iterdir()], [name])
            (self.folder / name).rmdir()
            self.folder.rmdir()
        self.folder.touch()
        self.refused("File exists", ExitCode.OUTPUT)

    def test_two_drivers_in_one_folder(self):
        child = self.hold()
        self.refused(f"process {child.pid} on {socket.gethostname()} works in it: wait for its end")
        child.kill()
        child.wait()
        self.assertEqual(json.loads((self.folder / LOCK).read_text())["pid"], child.pid)
        with claimed(self.folder):  # A killed driver's folder is taken over.
            self.assertEqual(json.loads((self.folder / LOCK).read_text())["pid"], os.getpid())

    def test_a_driver_on_another_machine(self):
        with claimed(self.folder):
            pass
        (self.folder / LOCK).write_text('{"host": "elsewhere", "pid": 7}')
        self.refused(f"process 7 on elsewhere works in it: .* if that has ended remove {LOCK}")

    def test_a_file_system_without_locks(self):
        with claimed(self.folder):
            pass
        with unittest.mock.patch("fcntl.flock", side_effect=OSError(95, "Operation not supported")):
            ended = subprocess.Popen(["true"])
            ended.wait()
            for pid, free in ((ended.pid, True), (os.getppid(), False), ("x", False)):
                (self.folder / LOCK).write_text(json.dumps({"host": socket.gethostname(), "pid": pid}))
                if free:
                    with claimed(self.folder):
                        pass
                else:
                    self.refused(f"process {pid} on")

    def test_locks_that_are_no_lock(self):
        with claimed(self.folder):
            pass
        for content in (b"", b"\xff", b"[" * 9000, b"[1]", b"{}", b'{"pid": 1e400}'):
            (self.folder / LOCK).write_bytes(content)
            with claimed(self.folder):
                pass

    def test_planted_links_are_refused(self):
        with claimed(self.folder):
            pass
        victim = self.folder.with_name("victim")
        victim.write_text("precious")
        (self.folder / "round_1").mkdir()
        for name in ("merged.exr", "journal.json", "round_1/counts_a.exr", "round_2"):
            (self.folder / name).symlink_to(victim)
            self.refused(f"{name}: is a link")
            (self.folder / name).unlink()
        self.assertEqual((self.folder / LOCK).read_text(), "")  # A driver that failed holds no lock.
        (self.folder / LOCK).unlink()
        os.mkfifo(self.folder / LOCK)
        self.refused("is not a regular file", ExitCode.OUTPUT)
        (self.folder / LOCK).unlink()
        os.link(victim, self.folder / LOCK)
        self.refused("is not a regular file with one name", ExitCode.OUTPUT)
        (self.folder / LOCK).unlink()
        (self.folder / LOCK).symlink_to(victim)
        self.refused("symbolic links", ExitCode.OUTPUT)
        self.assertEqual(victim.read_text(), "precious")


if __name__ == "__main__":
    unittest.main()


class ManyFolders(unittest.TestCase):
    def hold(self, hard_limit):
        """Claims a hundred folders in a process that may have 64 files open, and raise that to the hard limit."""
        with tempfile.TemporaryDirectory() as folder:
            words = [sys.executable, "-c", HOLD_MANY, folder, str(hard_limit)]
            return subprocess.run(words, cwd=ROOT, capture_output=True, text=True)

    def test_the_limit_of_open_files_is_raised(self):
        result = self.hold(400)
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_more_frames_than_the_system_allows_are_refused(self):
        result = self.hold(200)
        self.assertEqual(result.returncode, ExitCode.USAGE)
        self.assertIn("100 frames need 356 open files and the limit (ulimit -Hn) is 200", result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1)
