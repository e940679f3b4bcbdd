import tempfile
import unittest
from pathlib import Path

from pipelines.common.errors import DriverError, ExitCode
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.loop import report
from pipelines.loop.adaptive import Settings
from pipelines.loop.budget import Budget
from tests.pipelines.loop.synthetic import loop


class WithoutPreview(Polyrecon):
    def run_side_by_side(self, command, word_lists):
        if command == "preview":
            raise DriverError(ExitCode.MISSING, "polyrecon preview: no library for pictures")
        return super().run_side_by_side(command, word_lists)


class Report(unittest.TestCase):
    def test_a_finished_frame_does_not_fail_for_the_pictures_of_its_report(self):
        with tempfile.TemporaryDirectory() as folder:
            budget = Budget(samples=8)
            _, result = loop(folder, budget)
            settings = Settings(Path(folder, "out.exr"), Path(folder, "passes"), budget)
            for polyrecon, pictures in ((Polyrecon(), 2), (WithoutPreview(), 0)):
                page = report.write(result, settings, polyrecon)
                self.assertEqual(page.read_text(encoding="utf-8").count("<img"), pictures)
            note = "the report has no pictures: polyrecon preview: no library for pictures"
            self.assertIn(f"<p>{note}</p>", page.read_text(encoding="utf-8"))
            self.assertIn(f"  {note}", report.lines(result, settings, page))


if __name__ == "__main__":
    unittest.main()
