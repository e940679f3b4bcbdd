"""The bench of pictures: false edges of known patterns, which file is whose reference, and its table."""

import pathlib
import sys
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "tests" / "bench"))

import pictures  # noqa: E402
from false_edges import display_values, false_edges  # noqa: E402

from pipelines.common import exr  # noqa: E402

PIXELS = 20 * 30


def grey(value=0.2):
    return np.full((20, 30, 3), value)


def edges(image, reference):
    """Their number in the whole picture."""
    return round(false_edges(image, reference) * PIXELS / 1e4)


class FalseEdges(unittest.TestCase):
    def test_display_values_are_those_of_srgb(self):
        for radiance, shown in ((-1, 0), (0, 0), (0.002, 0.02584), (0.18, 0.46136), (1, 1), (50, 1)):
            self.assertAlmostEqual(shown, float(display_values(np.array(radiance))), 5)

    def test_the_reference_itself_has_none(self):
        steps = grey()
        steps[:, 15:] = 0.8
        self.assertEqual(0, edges(steps, steps))
        self.assertEqual(0, edges(grey(), grey()))

    def test_a_dot_has_four_in_any_colour(self):
        for colour in range(3):
            image = grey()
            image[7, 11, colour] = 0.3
            self.assertEqual(4, edges(image, grey()))
        image = grey()
        image[0, 0] = 0.3
        self.assertEqual(2, edges(image, grey()))

    def test_a_block_has_its_outline(self):
        image = grey()
        image[5:9, 5:12] = 0.1
        self.assertEqual(2 * (4 + 7), edges(image, grey()))

    def test_a_step_that_is_not_visible_counts_as_none(self):
        shown = float(display_values(np.array(0.2)))
        linear = [((shown + step + 0.055) / 1.055) ** 2.4 for step in (0.039, 0.041)]
        for value, count in zip(linear, (0, 4)):
            image = grey()
            image[7, 11] = value
            self.assertEqual(count, edges(image, grey()))

    def test_an_edge_two_pixels_off_is_none_and_three_pixels_off_is_false(self):
        known = grey(0.1)
        known[:, 15:] = 0.6
        for shift, rows in ((2, 0), (3, 20)):
            image = grey(0.1)
            image[:, 15 + shift :] = 0.6
            self.assertEqual(rows, edges(image, known))

    def test_where_the_screen_shows_white_there_are_none(self):
        image = grey(3)
        image[7, 11] = 60
        self.assertEqual(0, edges(image, grey(3)))


class Bench(unittest.TestCase):
    def test_renders_have_the_reference_of_the_longest_part_of_their_name(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for file in ("a_16", "a_16_oidn", "a_b_64", "a_b_ref", "a_ref", "a_c_8", "d_4"):
                exr.write(folder / f"{file}.exr", {"R": np.zeros((2, 3))})
            exr.write(folder / "a_small_16.exr", {"R": np.zeros((1, 3))})
            found = {render.stem: reference.stem for render, reference in pictures.renders_of(folder)}
        self.assertEqual({"a_16": "a_ref", "a_b_64": "a_b_ref", "a_c_8": "a_ref"}, found)

    def test_a_single_render_has_means_alone(self):
        channels = {f"Combined{kind}.{c}": np.zeros((2, 3)) for kind in ("", " A", " B", " Variance") for c in "RGB"}
        channels["Combined.A"] = channels["Depth.Z"] = np.ones((2, 3))
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            exr.write(folder / "in_16.exr", channels)
            (folder / "out").mkdir()
            stripped = pictures.single(folder / "in_16.exr", folder / "out")
            self.assertEqual(
                {"Combined.R", "Combined.G", "Combined.B", "Combined.A", "Depth.Z"}, set(exr.read(stripped))
            )
            self.assertEqual(stripped, pictures.single(stripped, folder))

    def test_the_table_has_a_row_for_each_picture_and_the_mean_over_the_peer(self):
        row = (0.02, 0.01, 0.1, 0.0025, 9.0)
        rows = {
            "a_16": {"standard": row, "oidn": (0.01, 0.01, 0.2, 0, 4.0)},
            "b_16": {"standard": row, "oidn": (0.04, 0.01, 0.2, 0, 9.0)},
        }
        lines = pictures.markdown(rows, ["oidn"], ["standard"]).splitlines()
        self.assertEqual(2 + 4 + 1, len(lines))
        self.assertEqual("| a_16 | standard | 0.02000 | 0.01000 | 0.1000 | +0.25 % | 9.0 |", lines[2])
        self.assertEqual("| mean of 2 | standard / oidn | 1.000 | 1.000 | 0.500 |  | 1.41 |", lines[-1])


if __name__ == "__main__":
    unittest.main()
