import os
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path

from pipelines.common.errors import DriverError, ExitCode
from pipelines.common.files import STALE_SECONDS, open_regular, remove_temporaries, replacing, write_text


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

    def test_missing_folders_are_made(self):
        write_text(self.path.parent / "gone" / "ö" / "a.json", "text")
        self.assertEqual((self.path.parent / "gone" / "ö" / "a.json").read_text(), "text")

    def test_a_folder_that_cannot_be_made_is_named(self):
        self.path.write_text("a file")
        with self.assertRaisesRegex(DriverError, "ä b.json/a.json: (Not a directory|File exists)") as caught:
            write_text(self.path / "a.json", "text")
        self.assertEqual(caught.exception.code, ExitCode.OUTPUT)

    def test_planted_links_are_replaced_and_not_followed(self):
        victim = self.path.with_name("victim")
        victim.write_text("precious")
        self.path.symlink_to(victim)
        for name in (f".{self.path.name}.new", f"{self.path.name}.new", f".{self.path.name}"):
            self.path.with_name(name).symlink_to(victim)
        write_text(self.path, "text")
        self.assertEqual((victim.read_text(), self.path.read_text()), ("precious", "text"))
        self.assertFalse(self.path.is_symlink())

    def test_a_name_that_was_guessed_is_refused_and_not_followed(self):
        victim = self.path.with_name("victim")
        victim.write_text("precious")
        with unittest.mock.patch("secrets.token_hex", return_value="0123456789abcdef"):
            self.path.with_name(f".{self.path.name}.polyrecon-0123456789abcdef").symlink_to(victim)
            with self.assertRaisesRegex(DriverError, "File exists"):
                write_text(self.path, "text")
        self.assertEqual(victim.read_text(), "precious")

    def test_what_killed_drivers_left_is_removed_and_nothing_else(self):
        old = time.time() - 2 * STALE_SECONDS
        left, foreign, others = (
            self.path.with_name(name)
            for name in (
                f".{self.path.name}.polyrecon-0123456789abcdef",
                f".{self.path.name}.backup",
                ".other.json.polyrecon-0123456789abcdef",
            )
        )
        for path in (left, foreign, others):
            path.touch()
            os.utime(path, (old, old))
        with replacing(self.path) as used:
            os.utime(used, (old, old))
            write_text(self.path, "text")  # The temporary that is in use is locked.
        self.assertEqual({p.name for p in self.path.parent.iterdir()}, {self.path.name, foreign.name, others.name})
        remove_temporaries(self.path.parent, lambda name: name == "other.json")
        self.assertEqual({p.name for p in self.path.parent.iterdir()}, {self.path.name, foreign.name})

    def test_the_longest_name_can_be_written(self):
        path = self.path.with_name("ä" * 127)
        write_text(path, "text")
        self.assertEqual(path.read_text(), "text")

    def test_a_pipe_is_refused_and_not_waited_for(self):
        os.mkfifo(self.path)
        with self.assertRaisesRegex(OSError, "is not a regular file"):
            open_regular(self.path)


if __name__ == "__main__":
    unittest.main()
