import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from pipelines.common.work_folder import WorkFolder

ROOT = Path(__file__).resolve().parents[3]
HOLD = """import sys
from pipelines.common.work_folder import WorkFolder

WorkFolder('toy_2', sys.argv[1])
print(flush=True)
input()
"""


class WorkFolders(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.parent = Path(folder.name)

    def names(self):
        return sorted(os.listdir(self.parent))

    def test_it_goes_at_its_end(self):
        with WorkFolder("a", self.parent) as folder:
            (folder / "sub").mkdir()
            self.assertEqual(folder.stat().st_mode & 0o777, 0o700)
        self.assertEqual(self.names(), [])

    def test_killed_drivers_leave_no_folder(self):
        words = [sys.executable, "-c", HOLD, self.parent]
        child = subprocess.Popen(words, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        child.stdout.readline()
        name = self.names()
        with WorkFolder("b", self.parent):
            self.assertEqual(len(self.names()), 2)  # The other driver runs.
        self.assertEqual(self.names(), name)
        child.kill()
        child.communicate()
        self.assertEqual(self.names(), name)
        with WorkFolder("b", self.parent) as folder:
            self.assertEqual(self.names(), [folder.name])
            (self.parent / name[0]).mkdir()  # The killed driver's renderer writes once more.
        self.assertEqual(self.names(), [])

    def test_others_are_left_alone(self):
        ended = subprocess.Popen(["true"])
        ended.wait()
        others = ["polyrecon-x", "polyrecon-blender-x1-2", f"other-a-{ended.pid}-x", f"polyrecon-a-{ended.pid}"]
        for name in others:
            (self.parent / name).mkdir()
        (self.parent / f"polyrecon-a-{ended.pid}-file").touch()
        (self.parent / f"polyrecon-a-{ended.pid}-link").symlink_to(self.parent / others[0])
        before = self.names()
        with WorkFolder("a", self.parent):
            pass
        self.assertEqual(self.names(), before)


if __name__ == "__main__":
    unittest.main()
