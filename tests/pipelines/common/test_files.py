import os
import tempfile
import unittest
import unittest.mock
from pathlib import Path

from pipelines.common.errors import DriverError, ExitCode
from pipelines.common.files import write_text


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "ä b.json"

    def test_a_text_replaces_the_one_before(self):
        for text in ("längere Zeile\n" * 3, "kurz", ""):
            write_text(self.path, text)
            self.assertEqual(self.path.read_text(encoding="utf-8"), text)
        self.assertEqual(os.listdir(self.path.parent), [self.path.name])

    def test_a_failed_write_leaves_the_file_before(self):
        write_text(self.path, "before")
        full = unittest.mock.patch("os.fsync", side_effect=OSError(28, "No space left on device"))
        with full, self.assertRaisesRegex(DriverError, "ä b.json: No space left on device") as caught:
            write_text(self.path, "after")
        self.assertEqual(caught.exception.code, ExitCode.OUTPUT)
        self.assertEqual(self.path.read_text(), "before")

    def test_a_folder_that_is_missing_is_named(self):
        with self.assertRaisesRegex(DriverError, "gone.*: No such file or directory"):
            write_text(self.path.parent / "gone" / "a.json", "text")


if __name__ == "__main__":
    unittest.main()
