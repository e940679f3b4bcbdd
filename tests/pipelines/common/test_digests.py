import hashlib
import os
import tempfile
import unittest
import unittest.mock
from pathlib import Path

from pipelines.common import digests
from pipelines.common.digests import InputDigests, changed_at, digest
from pipelines.common.errors import DriverError
from pipelines.common.scene_inputs import SceneInputs


def swap(path, content):
    """Replaces the content by another one of the same size, and sets the time of modification back."""
    status = path.stat()
    path.write_bytes(content)
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


class Digests(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.file = self.folder / "a ä"
        self.file.write_bytes(b"content")

    def of(self, path, known=None):
        return (known or InputDigests()).of({"name": [str(path)], str(path): [str(path)]})[str(path)]

    def test_a_file(self):
        self.assertEqual(digest(self.file), hashlib.sha256(b"content").hexdigest())
        self.assertEqual(self.of(self.file), digest(self.file))

    def test_the_same_size_and_time(self):
        known = InputDigests()
        before = self.of(self.file, known)
        swap(self.file, b"CONTENT")
        self.assertEqual(self.of(self.file, known), hashlib.sha256(b"CONTENT").hexdigest())
        swap(self.file, b"content")
        self.assertEqual(self.of(self.file, known), before)

    def test_a_file_is_read_once(self):
        known = InputDigests()
        self.of(self.file, known)
        with unittest.mock.patch.object(digests, "digest", side_effect=AssertionError("it was read again")):
            self.of(self.file, known)

    def test_a_folder_and_a_sequence(self):
        (self.folder / "cache").mkdir()
        for name in ("cache/one", "cache/two"):
            (self.folder / name).write_bytes(b"content")
        found = {self.of(self.folder / "cache")}
        swap(self.folder / "cache/two", b"CONTENT")
        found.add(self.of(self.folder / "cache"))
        (self.folder / "cache/two").rename(self.folder / "cache/zwei")
        found.add(self.of(self.folder / "cache"))
        (self.folder / "cache/three").touch()
        found.add(self.of(self.folder / "cache"))
        self.assertEqual(len(found), 4)
        self.assertEqual(InputDigests().of({"s_####": [], "x": []}).keys(), {"s_####", "x"})

    def test_what_cannot_be_read(self):
        os.mkfifo(self.folder / "pipe")
        self.assertEqual(self.of(self.folder / "pipe"), "is not a regular file")
        for path in ("/proc/kmsg", "/proc/self/pagemap", "/proc/kcore", "/dev/zero"):  # They have no end, or none soon.
            self.assertTrue(self.of(Path(path)))
        self.assertEqual(self.of(self.folder / "gone"), "No such file or directory")
        self.assertEqual(changed_at(self.folder / "gone"), 0)

    def test_more_than_the_limit_goes_by_size_and_times(self):
        small = self.folder / "small"
        small.write_bytes(b"x")
        with unittest.mock.patch.object(digests, "CONTENT_LIMIT", 4):
            names = {str(path): [str(path)] for path in (self.file, small)}
            before = InputDigests().of(names)
            self.assertEqual(before[str(small)], digest(small))
            self.assertNotEqual(before[str(self.file)], digest(self.file))
            self.assertEqual(InputDigests().of(names), before)
            swap(self.file, b"CONTENT")
            self.assertNotEqual(InputDigests().of(names), before)

    def test_a_scene_whose_files_change(self):
        inputs, path = SceneInputs(), str(self.file)
        inputs.opened([path], begin=changed_at(self.file))
        with self.assertRaisesRegex(DriverError, "a ä: changed while it was rendered"):
            SceneInputs().opened([path], begin=changed_at(self.file) - 1)
        self.assertEqual(inputs.begin_frame({"sequence": [path]}).keys(), {path, "sequence"})
        inputs.check()
        swap(self.file, b"CONTENT")
        with self.assertRaisesRegex(DriverError, "sequence: changed while it was rendered"):
            inputs.check()
        with self.assertRaisesRegex(DriverError, "a ä: changed while it was rendered"):
            inputs.opened([path], begin=changed_at(self.file))


if __name__ == "__main__":
    unittest.main()
