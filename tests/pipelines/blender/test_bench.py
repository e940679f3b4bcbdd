"""The bench of the adaptive loop: tuning of its methods, the files that it keeps, and one small run."""

import contextlib
import io
import json
import pathlib
import tempfile
import unittest

from tests.bench.blender import bench, report


def rows(knob, seconds_of, fixed, target, tries=bench.TRIES):
    """The rows of tuning runs on a machine whose rendering takes seconds_of(knob)."""
    found = []
    while len(found) < tries and not any(abs(row["seconds"] / target - 1) < bench.TOLERANCE for row in found):
        value = knob(found, target)
        found.append({"knob": value, "rendering": seconds_of(value), "seconds": fixed + seconds_of(value)})
    return found


class Tuning(unittest.TestCase):
    def test_samples_meet_the_seconds_quickly(self):
        found = rows(bench.next_samples, lambda samples: 0.06 * samples, fixed=3.0, target=20.0)
        self.assertLessEqual(len(found), 3)
        self.assertAlmostEqual(found[-1]["seconds"], 20.0, delta=0.8)
        self.assertEqual(found[-1]["knob"] % bench.PARTS, 0)

    def test_threshold_meets_the_seconds_whatever_the_slope(self):
        for slope in (0.8, 1.5, 2.4):
            with self.subTest(slope):
                found = rows(
                    bench.next_threshold, lambda t, slope=slope: 4.0 * (t / 0.02) ** -slope, fixed=2.5, target=15.0
                )
                self.assertAlmostEqual(found[-1]["seconds"], 15.0, delta=15.0 * bench.TOLERANCE)


class Run(unittest.TestCase):
    def call(self, *words):
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            code = bench.main([str(word) for word in words])
        return code, output.getvalue()

    def test_small_scene_end_to_end_and_nothing_is_rendered_twice(self):
        with tempfile.TemporaryDirectory() as folder:
            words = [
                "meadow",
                "--size=24x16",
                "--seconds=0.5",
                "--methods=oidn",
                "--reference-spp=128",
                "--work",
                folder,
            ]
            code, said = self.call(*words)
            self.assertEqual(code, 0, said)
            self.assertIn("| meadow | 0.5 s |", said)
            work = pathlib.Path(folder) / "24x16"
            kept = json.loads((work / "results_wall.json").read_text())
            self.assertEqual({row["method"] for row in kept}, {"oidn"})
            best = min(kept, key=lambda row: abs(row["seconds"] - 0.5))
            self.assertTrue(0 < best["relMSE"] < 1, best)
            self.assertTrue((work / "meadow" / best["image"]).exists())
            before = {path: path.stat().st_mtime_ns for path in work.rglob("*.exr")}
            self.assertIn("| meadow | 0.5 s |", self.call(*words)[1])
            self.assertEqual({path: path.stat().st_mtime_ns for path in work.rglob("*.exr")}, before)
            # The picture of a run that is not the nearest; the next run overwrites it.
            before.pop(work / "meadow" / "trial.exr", None)
            self.call(*words, "--draws=2")
            self.assertEqual({path: path.stat().st_mtime_ns for path in before}, before)
            first, second = (
                min(
                    (r for r in json.loads((work / "results_wall.json").read_text()) if r["draw"] == draw),
                    key=lambda row: abs(row["seconds"] - 0.5),
                )
                for draw in (1, 2)
            )
            self.assertEqual(first["image"], best["image"])
            self.assertTrue((work / "meadow" / second["image"]).exists())
            self.assertNotEqual(second["relMSE"], first["relMSE"])

    def test_a_blend_file_is_rendered_by_cycles_whatever_its_engine(self):
        import bpy

        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "file.blend"
            bpy.ops.wm.read_factory_settings()  # a cube, rendered by EEVEE
            bpy.ops.wm.save_as_mainfile(filepath=str(file))
            before = file.read_bytes()
            code, said = self.call(
                file, "--size=24x16", "--seconds=0.5", "--methods=oidn", "--reference-spp=128", "--work", folder
            )
            self.assertEqual(code, 0, said)
            self.assertIn("| file | 0.5 s |", said)
            self.assertEqual(file.read_bytes(), before)

    def test_wrong_use(self):
        for words in (
            ["nowhere"],
            ["glass", "--methods=magic"],
            ["--seconds=soon"],
            ["--reference-spp=65"],
            ["a/glass.blend"],
            ["a/x.blend", "b/x.blend"],
        ):
            with (
                self.subTest(words),
                contextlib.redirect_stderr(io.StringIO()),
                self.assertRaises(SystemExit) as raised,
            ):
                bench.arguments(words)
            self.assertEqual(raised.exception.code, 2)


class Report(unittest.TestCase):
    def test_ratios(self):
        figures = (("uniform", 0.02, 0.01), ("adaptive", 0.01, 0.008), ("prior", 0.004, 0.004))
        made = [
            {"scene": "fan", "budget": 9.0, "method": m, "seconds": 9.1, "relMSE": e, "trimmed": t}
            for m, e, t in figures
        ]
        table = report.table(made)
        cells = "| 0.02000 / 0.01000 (9.1 s) | 0.01000 / 0.00800 (9.1 s) | 0.00400 / 0.00400 (9.1 s) |"
        self.assertIn(f"| fan | 9 s {cells} 0.50 / 0.80 | 0.20 / 0.40 |", table)
        self.assertIn("| (b) / (a) | (e) / (a) |", table)

    def test_draws_are_averaged(self):
        made = [
            {"scene": "fan", "budget": 9.0, "method": "oidn", "seconds": s, "relMSE": e, "trimmed": e / 2}
            for s, e in ((8.0, 0.01), (9.0, 0.04))
        ]
        self.assertIn("| fan | 9 s | 0.02000 / 0.01000 (8.5 s) |", report.table(made))


if __name__ == "__main__":
    unittest.main()
