"""Frame names and frame ranges follow the table that the tests of the program read too."""

import argparse
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from pipelines.common.command import add_frame_arguments, each_frame
from pipelines.common.errors import DriverError, ExitCode
from pipelines.common.frame_names import frame_path, is_pattern, parse_ranges, ranges_text

TABLE = json.loads((Path(__file__).parents[2] / "inputs" / "frame_names.json").read_text(encoding="utf-8"))


class Names(unittest.TestCase):
    def test_every_name_of_the_table(self):
        for row in TABLE["names"]:
            with self.subTest(row):
                self.assertTrue(is_pattern(row["pattern"]))
                self.assertEqual(frame_path(row["pattern"], row["frame"]), row["name"])
                self.assertEqual(frame_path(Path(row["pattern"]), row["frame"]), row["name"])

    def test_names_without_a_place(self):
        for name in TABLE["no_patterns"]:
            with self.subTest(name):
                self.assertFalse(is_pattern(name))

    def test_names_that_no_frame_has(self):
        for row in TABLE["no_frames"]:
            with self.subTest(row):
                for number in {int(word) for word in re.findall("-?[0-9]+", row["name"])}:
                    self.assertNotEqual(frame_path(row["pattern"], number), row["name"])


class Folders(unittest.TestCase):
    def test_a_folder_of_this_very_name_has_no_places(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("####", "job #3", "%04d"):
                place = name if name != "job #3" else "#"
                os.mkdir(os.path.join(folder, name))
                self.assertEqual(frame_path(f"{folder}/{name}/s.{place}.exr", 7)[len(folder) :].split("/")[1], name)
            self.assertEqual(frame_path(f"{folder}/###/s.###.exr", 7), f"{folder}/007/s.007.exr")


class Ranges(unittest.TestCase):
    def test_every_range_of_the_table(self):
        for row in TABLE["ranges"]:
            with self.subTest(row):
                self.assertEqual(parse_ranges(row["text"]), row["frames"])

    def test_refused_ranges(self):
        for text in TABLE["refused_ranges"]:
            with self.subTest(text), self.assertRaisesRegex(DriverError, f"^--frames {re.escape(text)}: ") as caught:
                parse_ranges(text)
            self.assertEqual(caught.exception.code, ExitCode.USAGE)

    def test_numbers_of_thousands_of_digits(self):
        for text in ("9" * 5000, "-" + "9" * 5000, "1-" + "9" * 5000, "1-2x" + "9" * 5000):
            with self.assertRaisesRegex(DriverError, "is too large"):
                parse_ranges(text)
        self.assertEqual(parse_ranges("0" * 5000 + "7"), [7])

    def test_as_many_frames_as_are_taken(self):
        self.assertEqual(len(parse_ranges("1-1000000")), 1_000_000)
        with self.assertRaisesRegex(DriverError, "more than 1000000 frames"):
            parse_ranges("1-1000000,2000000")

    def test_texts(self):
        for row in TABLE["texts"]:
            with self.subTest(row):
                self.assertEqual(ranges_text(row["frames"]), row["text"])

    def test_texts_keep_the_order(self):
        for frames in ([3, 1, 2], [-3, -2, 7, 8, 20], [9, 1, 2, 3]):
            self.assertEqual(parse_ranges(ranges_text(frames)), frames)


class Driver:
    """A renderer and its frames, as each_frame visits them."""

    def __init__(self):
        self.closed, self.frames = False, []

    def close(self):
        self.closed = True

    def visit(self, frame, polyrecon, progress):
        self.frames.append((frame.number, str(frame.output), str(frame.passes)))


class EachFrame(unittest.TestCase):
    def frames(self, *words):
        parser = argparse.ArgumentParser()
        add_frame_arguments(parser)
        driver = Driver()
        try:
            each_frame(parser.parse_args([*words, "--polyrecon", os.environ["POLYRECON"]]), driver, driver.visit)
        finally:
            self.assertTrue(driver.closed)
        return driver.frames

    def test_pictures_and_folders_of_passes(self):
        self.assertEqual(self.frames("-o", "a.exr"), [(None, "a.exr", "a.passes")])
        self.assertEqual(self.frames("-o", "a_#.exr"), [(None, "a_#.exr", "a_#.passes")])
        self.assertEqual(self.frames("-o", "a.exr", "--frame=7"), [(7, "a.exr", "a.passes")])
        self.assertEqual(self.frames("-o", "a_##.exr", "--frame=-7"), [(-7, "a_-07.exr", "a_-07.passes")])
        two = [(3, "a_03.exr", "a.passes/0003"), (4, "a_04.exr", "a.passes/0004")]
        self.assertEqual(self.frames("-o", "a_##.exr", "--frames=3-4"), two)
        one = [(3, "x/####/03/03.exr", "x/####/shot.passes/0003")]
        self.assertEqual(self.frames("-o", "x/####/##/##.exr", "--frames=3"), one)
        two = [(-3, "a_-03.exr", "p/-0003"), (4, "a_04.exr", "p/0004")]
        self.assertEqual(self.frames("-o", "a_##.exr", "--frames=-3,4", "--passes-dir", "p"), two)

    def test_several_frames_need_a_place_for_their_number(self):
        for output in ("a.exr", "##/a.exr"):
            with self.assertRaisesRegex(DriverError, f"^-o {output}: ") as caught:
                self.frames("-o", output, "--frames=3-4")
            self.assertEqual(caught.exception.code, ExitCode.USAGE)


class TheProgram(unittest.TestCase):
    def test_names_are_those_of_the_program(self):
        """The program prints the names of missing files."""
        with tempfile.TemporaryDirectory() as folder:
            for pattern in ("a.####.exr", "b_%04d.exr", "c#.exr", "d.%d.exr"):
                words = ["denoise", "-i", f"{folder}/{pattern}", "-o", f"{folder}/o.####.exr", "--frames=-3,7,12345"]
                done = subprocess.run([os.environ["POLYRECON"], *words, "--dry-run"], capture_output=True, text=True)
                for frame in (-3, 7, 12345):
                    self.assertIn(f"{folder}/{frame_path(pattern, frame)}: ", done.stderr)


if __name__ == "__main__":
    unittest.main()
