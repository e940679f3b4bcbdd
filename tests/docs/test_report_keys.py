"""The pages of docs/reference have a row for each key that the program and the drivers print, with its type, and each
row's key is printed in one of the runs made here."""

import contextlib
import io
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from pipelines.common.errors import DriverError, ExitCode
from pipelines.farm.job import Job
from pipelines.loop.budget import Budget
from tests.pipelines.loop.synthetic import SyntheticRenderer, loop

from . import tree

PROGRAM = os.environ["POLYRECON"]
SAMPLES = pathlib.Path(os.environ["POLYRECON_SAMPLES"])
SMALL = SAMPLES / "study_small_0.exr"
REFERENCE = "docs/reference"


def run(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        raise AssertionError(f"polyrecon {' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")
    return done


def leaves(value, path=""):
    """(key path, value) of everything that is no object: `a.b`, `list[].c`; a list of objects counts itself too."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, f"{path}.{key}" if path else key)
        return
    yield path, value
    if isinstance(value, list):
        for inner in value:
            if isinstance(inner, dict):
                yield from leaves(inner, path + "[]")


def is_of_type(value, name):
    if count := re.fullmatch(r"list of (\d+) numbers", name):
        return is_of_type(value, "list of numbers") and len(value) == int(count[1])
    if match := re.fullmatch(r"list of (\w+)s", name):
        return isinstance(value, list) and all(is_of_type(inner, match[1]) for inner in value)
    if isinstance(value, bool):
        return name == "boolean"
    kinds = {"string": str, "integer": int, "number": (int, float), "list": list, "object": dict, "null": type(None)}
    return isinstance(value, kinds[name])


def documented(page):
    """{key: type} of all tables of keys of a page."""
    sections = re.split(r"^## ", tree.read(f"{REFERENCE}/{page}"), flags=re.M)
    return {row[0].strip("`"): row[1] for text in sections for row in tree.table(text, "key")}


class StoppingRenderer(SyntheticRenderer):
    """Renders the first pass and fails in the first round."""

    def uniform(self, first, samples, target):
        SyntheticRenderer.extra(self, first, np.full(self.mean.shape, samples), target)

    def extra(self, first, counts, target):
        raise DriverError(ExitCode.RENDERER, "no more light")


class Keys(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def check(self, page, *printed):
        """All documents of one kind, printed by different runs, against the page."""
        table, seen = documented(page), set()
        for path, value in (leaf for document in printed for leaf in leaves(document)):
            seen.add(path)
            key = next((key for key in table if re.fullmatch(re.escape(key).replace("NAME", ".+"), path)), None)
            self.assertIsNotNone(key, f"{page}: no row for `{path}`")
            fits = any(is_of_type(value, name) for name in table[key].split(" or "))
            self.assertTrue(fits, f"{page}: `{key}` is {value!r}, documented as {table[key]}")
            seen.add(key)
        # An object that may be null has a row of its own; where it is one, its keys were seen.
        never = [key for key in table if key not in seen and not any(path.startswith(key + ".") for path in seen)]
        self.assertEqual([], never, f"{page}: documented, but not printed")

    def denoise(self, *options):
        report = self.folder / "report.json"
        run("denoise", "-i", SMALL, "-o", self.folder / "clean.exr", "--report", report, "--overwrite", "-q", *options)
        return json.loads(report.read_text())

    def test_report_of_denoise(self):
        plain = self.denoise("--quality", "draft")
        ample, scarce = (self.denoise("--time-budget", seconds) for seconds in ("60", "0.001"))
        self.check("report.md", plain, ample, scarce)

    def test_inspect(self):
        merged = self.folder / "merged.exr"
        run("merge", *sorted(SAMPLES.glob("study_small_*.exr"))[:2], "-o", merged, "--quiet")
        found = [json.loads(run("inspect", path, "--json").stdout) for path in (merged, SMALL)]
        self.check("inspect_json.md", *found)

    def test_compare(self):
        done = run("compare", SMALL, SAMPLES / "study_small_1.exr", "--json")
        self.check("compare.md", json.loads(done.stdout))

    def test_progress(self):
        for frame in (1, 2):
            (self.folder / f"shot.{frame}.exr").symlink_to(SMALL)
        words = ["-i", self.folder / "shot.#.exr", "-o", self.folder / "clean.#.exr", "--quality", "draft"]
        lines = run("denoise", *words, "--frames", "1-2", "--progress", "json").stderr.splitlines()
        self.check("progress.md", *map(json.loads, lines))

    def test_progress_of_the_loop(self):
        lines = io.StringIO()
        with contextlib.redirect_stderr(lines):
            loop(self.folder / "samples", Budget(samples=24), frame=7, style="json")
            loop(self.folder / "seconds", Budget(seconds=20), max_rounds=1, style="json")
        self.check("driver_progress.md", *map(json.loads, lines.getvalue().splitlines()))

    def test_journal_of_the_loop(self):
        """Journals of a loop whose renderer fails in the first round, and of one that runs to its end."""
        with self.assertRaises(DriverError):
            loop(self.folder / "stopped", Budget(samples=24), renderer=StoppingRenderer())
        loop(self.folder / "finished", Budget(samples=24))
        journals = [self.folder / name / "passes" / "journal.json" for name in ("stopped", "finished")]
        self.check("journal.md", *(json.loads(path.read_text()) for path in journals))

    def test_report_of_a_farm(self):
        """Two of three frames are there, so that the report has a reason and a failed attempt to tell."""
        for frame in (1, 2):
            (self.folder / f"shot.{frame}.exr").symlink_to(SMALL)
        places = [str(self.folder / name) for name in ("shot.#.exr", "clean.#.exr")]
        job = Job(*places, [1, 2, 3], PROGRAM, ["--quality", "draft", "--frame-radius", "0"], chunk=3)
        job.save(self.folder / "job")
        for program, *words in (("task.py", self.folder / "job", "0"), ("report.py", self.folder / "job")):
            command = [sys.executable, "-B", tree.ROOT / "pipelines" / "farm" / program, *words]
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(4, done.returncode, done.stderr)
        self.check("farm.md", json.loads((self.folder / "job" / "report.json").read_text()))


class TheCheckItself(unittest.TestCase):
    def test_leaves(self):
        value = {"a": {"b": 1, "c": []}, "d": [{"e": None}, {"e": "x"}], "f": [1, 2]}
        paths = ["a.b", "a.c", "d", "d[].e", "d[].e", "f"]
        self.assertEqual(paths, [path for path, _ in leaves(value)])

    def test_types(self):
        self.assertTrue(is_of_type([1, 2.5, 3], "list of 3 numbers"))
        self.assertFalse(is_of_type([1, 2], "list of 3 numbers"))
        self.assertFalse(is_of_type(True, "integer"))
        self.assertFalse(is_of_type(None, "number"))
        self.assertTrue(is_of_type([{}], "list of objects"))


if __name__ == "__main__":
    unittest.main()
