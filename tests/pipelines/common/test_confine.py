import os
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

from pipelines.common import confine

WRITES = """
import os, sys
inside, outside = sys.argv[1:]
def denied(function, *words):
    try:
        function(*words)
    except OSError as error:
        assert error.errno in (1, 13, 18), error  # not permitted, access denied, across folders
    else:
        raise SystemExit(f"{function} {words}")
open(f"{inside}/new", "w").write("x")
os.mkdir(f"{inside}/sub")
os.rename(f"{inside}/new", f"{inside}/sub/new")
open("/dev/null", "w").write("x")
assert open(f"{outside}/old").read() == "precious"
os.symlink(f"{outside}/old", f"{inside}/link")
for path in (f"{outside}/old", f"{outside}/new", f"{inside}/link"):
    denied(open, path, "w")
    denied(open, path, "a")
denied(os.truncate, f"{outside}/old", 0)
denied(os.unlink, f"{outside}/old")
denied(os.mkdir, f"{outside}/sub")
denied(os.symlink, "x", f"{outside}/link")
denied(os.mkfifo, f"{outside}/fifo")
denied(os.rename, f"{outside}/old", f"{inside}/old")
denied(os.rename, f"{inside}/sub/new", f"{outside}/old")
denied(os.link, f"{outside}/old", f"{inside}/old")
"""


@unittest.skipUnless(confine.why_not(sys.executable) == "", "this kernel has no Landlock")
class Confinement(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for name in ("in ä", "out"):
            (self.folder / name).mkdir()
        (self.folder / "out/old").write_text("precious")

    def run_confined(self, *words):
        command = confine.confined([os.fspath(word) for word in words], [self.folder / "in ä"])
        return subprocess.run(command, capture_output=True, text=True)

    def test_only_the_folder_can_be_written_into(self):
        done = self.run_confined(sys.executable, "-c", WRITES, self.folder / "in ä", self.folder / "out")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(os.listdir(self.folder / "out"), ["old"])
        self.assertEqual((self.folder / "out/old").read_text(), "precious")

    def test_words_and_exit_codes_pass_through(self):
        done = self.run_confined("/bin/sh", "-c", 'echo "$@"; exit 5', "sh", "--", "a b", "-x")
        self.assertEqual((done.returncode, done.stdout), (5, "-- a b -x\n"))

    def test_children_are_confined_too(self):
        done = self.run_confined("/bin/sh", "-c", f"sh -c 'echo x > {self.folder}/out/new'")
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(os.listdir(self.folder / "out"), ["old"])

    def test_programs_that_cannot_be_confined(self):
        script = self.folder / "script"
        script.write_text("#!/bin/sh\n")
        self.assertIn("is a script", confine.why_not(script))
        snap = self.folder / "snap"
        snap.write_bytes(Path("/bin/true").read_bytes())
        (self.folder / "blender").symlink_to(snap)
        self.assertIn("snap", confine.why_not(self.folder / "blender"))
        with unittest.mock.patch.object(confine, "_version", return_value=-1):
            self.assertIn("no Landlock", confine.why_not("/bin/true"))


if __name__ == "__main__":
    unittest.main()
