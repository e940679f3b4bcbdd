import dataclasses
import json
import re
import tempfile
import unittest
import unittest.mock
from pathlib import Path

from pipelines.common.command import Frame
from pipelines.common.errors import DriverError, ExitCode
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.loop import report
from pipelines.loop.budget import Budget
from pipelines.loop.frame import Settings
from tests.pipelines.loop.synthetic import loop


class WithoutPictures(Polyrecon):
    def run_side_by_side(self, command, word_lists):
        if command == "view" and json.loads(Path(word_lists[0][1]).read_text(encoding="utf-8"))["images"]:
            raise DriverError(ExitCode.MEMORY, "polyrecon view: not enough memory")
        return super().run_side_by_side(command, word_lists)


def scene(page):
    """What the page says of its images."""
    return json.loads(re.search('<script type="application/json" id="scene">(.*)</script>', page)[1])


class Report(unittest.TestCase):
    def test_a_finished_frame_does_not_fail_for_the_pictures_of_its_report(self):
        with tempfile.TemporaryDirectory() as folder:
            budget = Budget(samples=8)
            _, result = loop(folder, budget)
            settings = Settings(Frame(None, Path(folder, "passes"), Path(folder, "out.exr")), budget)
            pages = [Path(folder, "pages", "a.html"), Path(folder, "b.html")]
            report.write(result, settings, Polyrecon(), pages)
            text = pages[0].read_text(encoding="utf-8")
            self.assertEqual(text, pages[1].read_text(encoding="utf-8"))
            shown = scene(text)
            rounds = len(result.state.rounds)
            self.assertEqual(len(shown["frames"]), rounds + 1)
            self.assertEqual([image["name"] for image in shown["images"][:3]], ["input", "result", "estimated error"])
            self.assertTrue(all(frame for image in shown["images"][:3] for frame in image["frames"]))
            self.assertEqual(text.count("<circle"), rounds + 1)
            report.write(result, settings, WithoutPictures(), pages)
            text = pages[0].read_text(encoding="utf-8")
            self.assertEqual(scene(text)["images"], [])
            note = "the report has no pictures: polyrecon view: not enough memory"
            self.assertIn(f"<p>{note}</p>", text)
            self.assertIn(note, result.audit.notes)

    def test_an_axis_has_at_least_three_ticks(self):
        for values in ([14.7, 17.2], [15, 15], [1, 100], [3e-5, 6e-5]):
            ticks = report.LogAxis(values, 100, 0).ticks()
            self.assertGreaterEqual(len(ticks), 3, values)
            self.assertTrue(all(0 <= tick["at"] <= 100 for tick in ticks), ticks)

    def test_a_frame_ends_in_three_lines(self):
        with tempfile.TemporaryDirectory() as folder:
            for budget, more in ((Budget(samples=16), "--budget-spp 40"), (Budget(target=0.02), "--target 0.01")):
                _, result = loop(Path(folder, str(budget)), budget)
                settings = Settings(Frame(7, Path(folder, "passes"), Path(folder, "out.exr")), budget)
                read, done, better = report.lines(result, settings, False, Polyrecon())
                self.assertIn(f"out.exr: frame 7, 96 x 64, synthetic, {result.samples:.3g} samples per pixel", read)
                self.assertIn(f"relative MSE {result.noise:.3g} before, {result.error:.3g} estimated after", done)
                self.assertLess(result.error, result.noise)
                self.assertIn(f"{more} halves the error", better)
                with unittest.mock.patch.dict("os.environ", {"POLYRECON_OIDN": "/nowhere"}):
                    better = report.lines(result, settings, False, Polyrecon())[-1]
                self.assertIn("; --with-prior (after pip install pyoidn), since the samples are few", better)
                self.assertGreater(len(report.lines(result, settings, True, Polyrecon())), 4)

    def test_what_was_missed_is_said(self):
        with tempfile.TemporaryDirectory() as folder:
            _, result = loop(Path(folder), Budget(samples=8), max_rounds=1)
            for limit, said in (
                (Budget(samples=8), "^$"),
                (Budget(target=result.error), "^$"),
                (Budget(target=result.error / 2), f"^estimated relMSE {result.error:.3g}, so --target .* was missed: "),
                (Budget(seconds=result.seconds), "^$"),
                (Budget(seconds=result.seconds / 1.2), "^took .* s, so --budget-seconds .* was missed$"),
            ):
                self.assertRegex(report.missed(result, limit), said)
            impossible = Budget(target=result.error / 2)
            ended = dataclasses.replace(result, why_ended="--max-rounds 4 is reached")
            settings = Settings(Frame(7, Path(folder, "passes"), Path(folder, "out.exr")), impossible, max_rounds=4)
            self.assertEqual(report.advice(ended, settings, Polyrecon()), "--max-rounds 8")
            without_error = dataclasses.replace(result, error=float("nan"))
            self.assertIn("estimated relMSE unknown", report.missed(without_error, impossible))


if __name__ == "__main__":
    unittest.main()
