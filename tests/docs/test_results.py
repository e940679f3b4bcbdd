"""The scripts that the marks in docs/results and docs/reference name write the tables between them. accuracy.py is
tried with made-up figures on a copy of its page: the four tables are right and nothing else of the page changes."""

import pathlib
import re
import shutil
import sys
import tempfile
import types
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULTS = ROOT / "docs" / "results"
INPUTS = ROOT / "docs" / "reference" / "inputs.md"
sys.path.append(str(ROOT / "tests" / "bench"))

import accuracy  # noqa: E402
import inputs  # noqa: E402

from tests.bench.blender import report  # noqa: E402

MARK = re.compile(r"<!-- (\w+): made by (\S+) -->\n\n(.*?)\n\n<!-- end of (\w+) -->", re.DOTALL)


def found():
    """As `polyrecon sweep --csv` has it: each setting with twice the time and the error times 1.5 of the one before."""
    settings = ["standard", *accuracy.BUDGET_SETTINGS, *(setting for _, setting in accuracy.PARTS)]
    settings += ["noisy", accuracy.ALL_STEPS, "stride 2", "order 1"]
    unique = list(dict.fromkeys(settings))
    rows = {s: {"seconds": str(2.0**k), "relMSE": str(0.001 * 1.5**k)} for k, s in enumerate(unique)}
    return {sample: dict(rows) for sample in accuracy.SAMPLES}


def row(text, name):
    return next(line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith(f"| {name} |"))


class Results(unittest.TestCase):
    def test_each_mark_is_closed_and_names_a_script(self):
        names = []
        for page in [*sorted(RESULTS.glob("*.md")), INPUTS]:
            text = page.read_text(encoding="utf-8")
            marks = MARK.findall(text)
            self.assertEqual(len(re.findall("^<!-- .*made by", text, re.MULTILINE)), len(marks), page)
            for begin, script, _, end in marks:
                self.assertEqual(begin, end, page)
                self.assertTrue((ROOT / script).is_file(), f"{page}: {script}")
                names.append((page.name, begin))
        written = [("accuracy.md", name) for name in ("budget", "parts", "numbers", "steps")]
        written += [("adaptive.md", "bench"), ("reliability.md", "reliability"), ("inputs.md", "inputs")]
        written += [("pictures.md", "figures"), ("pictures.md", "crops")]
        self.assertEqual(sorted(written), sorted(names))

    def test_each_commit_is_a_hash(self):
        for page in [*sorted(RESULTS.glob("*.md")), INPUTS]:
            for commit in re.findall(r"\bcommit\s+(\w+)\)", page.read_text(encoding="utf-8")):
                self.assertRegex(commit, r"^[0-9a-f]{7,40}$", page)

    def test_every_kind_of_file_has_a_row(self):
        [(_, _, text, _)] = MARK.findall(INPUTS.read_text(encoding="utf-8"))
        rows = [line.strip("| ").split(" | ")[0] for line in text.splitlines()[2:]]
        self.assertEqual([kind.__doc__ for kind in inputs.KINDS], rows)

    def test_accuracy_writes_its_four_tables_and_nothing_else(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(shutil.copy(RESULTS / "accuracy.md", folder))
            before = page.read_text(encoding="utf-8")
            accuracy.write_tables(page, found())
            after = page.read_text(encoding="utf-8")
        self.assertEqual(MARK.sub("", before), MARK.sub("", after))
        tables = {name: text for name, _, text, _ in MARK.findall(after)}
        samples = len(accuracy.SAMPLES)
        self.assertEqual(
            [*["1.00"] * samples, *["0.00100"] * samples, "1.00", "1.000"], row(tables["budget"], "standard")[1:]
        )
        # "draft, order 0" comes next after standard: 2 times its time, 1.5 times its error.
        self.assertEqual(["2.00", "1.500"], row(tables["budget"], "draft, order 0")[-2:])
        self.assertIn("all features", tables["parts"])
        self.assertEqual(1 + samples + 2, len(row(tables["numbers"], "stride 2")))
        self.assertNotIn("order 0", tables["numbers"])
        self.assertEqual(
            set(accuracy.SAMPLES), {line.split(" | ")[0].strip("| ") for line in tables["steps"].splitlines()[2:]}
        )

    def test_the_bench_writes_its_table_and_nothing_else(self):
        rows = [
            {"scene": "glass", "budget": 30, "method": method, "relMSE": error, "trimmed": error / 2, "seconds": 31}
            for method, error in (("uniform", 0.004), ("adaptive", 0.003))
        ]
        options = types.SimpleNamespace(size="8x8", reference_spp=16, draws=1, clock="wall")
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(report, "plot") as plot:
            page = pathlib.Path(shutil.copy(RESULTS / "adaptive.md", folder))
            before = page.read_text(encoding="utf-8")
            report.write(page, rows, options)
            after = page.read_text(encoding="utf-8")
            plot.assert_called_once_with(rows, page.with_suffix(".svg"), "seconds")
        self.assertEqual(MARK.sub("", before), MARK.sub("", after))
        [(_, _, table, _)] = MARK.findall(after)
        self.assertEqual("0.75 / 0.75", row(table, "glass")[-1])

    def test_a_setting_that_no_sweep_has_is_an_error(self):
        with self.assertRaisesRegex(SystemExit, "no such part"):
            accuracy.ratios_table(found(), [("label", "no such part")], True)

    def test_a_page_without_the_mark_is_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder, "page.md")
            page.write_text("no mark", encoding="utf-8")
            with self.assertRaises(ValueError):
                accuracy.write_between(page, "parts", "text")
            self.assertEqual("no mark", page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    unittest.main()
