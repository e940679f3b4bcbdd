import contextlib
import copy
import dataclasses
import hashlib
import io
import json
import math
import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

from pipelines.common import exr
from pipelines.common.errors import DriverError, ExitCode, run_main
from pipelines.loop.folder import PassFolder
from pipelines.loop.journal import VERSION, Journal, Part, Round, RoundPlan, State
from tests.pipelines.loop import journal_attacks, synthetic

IDENTITY = {"scene": "/a ä.blend", "frame": None, "first_pass": 8, "options": ["+W64"]}
EMPTY = hashlib.sha256().hexdigest()
PARTS = [
    Part("part_0a0.exr", "a", 0, 0, 4.0, 4.0, 1.5, False, EMPTY),
    Part("part_0b0.exr", "b", 0, 4, 4.0, 4.0, 0.25, False, EMPTY),
    Part("part_1a0.exr", "a", 1, 16, 3.7, 4.0, 2.0, True, EMPTY),
]
ROUNDS = [Round(0, 8.0, 3.0, 0.5, None, 8.0)]
PLAN = RoundPlan(1, {"a": 16, "b": 32}, 1, 0, 8.0, {"a": EMPTY, "b": EMPTY})
INPUTS = {"/a ä.blend": "1" * 64, "/lib.blend": "2" * 64}

MISSING = object()
WRONG_VALUES = (MISSING, None, True, "x", "", -1, -0.5, math.nan, math.inf, 10**400, [], {}, [1], {"a": 1})

# Values of WRONG_VALUES that are right at some places.
ALLOWED = {
    "identity": ({}, {"a": 1}),  # Another identity is refused, but as one.
    "parts": ([],),
    "rounds": ([],),
    "next_round": (None,),
    "inputs": ({},),  # Others are compared with the scene's.
    "error": (None,),
    "masked": (True,),
}


def leaves(value, place=()):
    """Places of all values in a JSON document."""
    yield place
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from leaves(item, (*place, key))


def with_value(document, place, value):
    document = copy.deepcopy(document)
    container = document
    for key in place[:-1]:
        container = container[key]
    if value is MISSING:
        del container[place[-1]]
    else:
        container[place[-1]] = value
    return document


class Journals(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = PassFolder(Path(folder.name) / "passes ä")
        self.enter(self.folder.claimed())
        self.folder.create_round(1)
        for part in PARTS:
            (self.folder.path / part.file).touch()
        for half in "ab":
            self.folder.in_round(1, f"counts_{half}").touch()
        state = State(dict(IDENTITY), 7.5, 2, 17, list(PARTS), list(ROUNDS), PLAN, dict(INPUTS))
        Journal(self.folder.journal, state).save()
        self.document = json.loads(self.folder.journal.read_text(encoding="utf-8"))

    def enter(self, context):
        self.addCleanup(context.__exit__, None, None, None)
        return context.__enter__()

    def open(self, resume=True, **identity):
        return Journal.open(self.folder, State({**IDENTITY, **identity}), resume)

    def write(self, document):
        self.folder.journal.write_text(document if isinstance(document, str) else json.dumps(document))

    def refused(self, document, line=".", code=ExitCode.BAD_INPUT):
        """The journal is refused by one line that names it and ends with what to do."""
        self.write(document)
        with self.assertRaisesRegex(DriverError, line) as caught:
            self.open()
        text = str(caught.exception)
        self.assertEqual(caught.exception.code, code, text)
        self.assertEqual(len(text.splitlines()), 1, text)
        self.assertIn(str(self.folder.path), text)
        self.assertTrue(text.endswith("another --passes-dir"), text)

    def test_what_is_saved_comes_back(self):
        journal = self.open()
        self.assertEqual((journal.state.parts, journal.state.rounds), (PARTS, ROUNDS))
        self.assertEqual((journal.state.next_round, journal.state.identity), (PLAN, IDENTITY))
        self.assertEqual((journal.state.first_pass_parts, journal.state.next_sample), (2, 17))
        # The clock goes on where it stopped.
        self.assertGreaterEqual(journal.seconds(), 7.5)
        self.assertLess(journal.seconds(), 7.5 + 30)
        self.assertEqual([path.name for path in self.folder.path.glob(".*")], [])

    def test_a_new_folder_gets_a_new_journal(self):
        self.folder.journal.unlink()
        state = State({"frame": 3}, first_pass_parts=8)
        self.assertIs(Journal.open(self.folder, state, resume=True).state, state)

    def test_passes_are_not_overwritten_without_resume(self):
        with self.assertRaisesRegex(DriverError, "journal.json: .*--resume") as caught:
            self.open(resume=False)
        self.assertEqual(caught.exception.code, ExitCode.USAGE)

    def test_other_passes_are_not_continued(self):
        for identity in ({"first_pass": 16}, {"seed": 1}, {"options": []}, {"frame": 0}):
            with self.assertRaisesRegex(DriverError, f"'{next(iter(identity))}' was .*, is ") as caught:
                self.open(**identity)
            self.assertEqual(caught.exception.code, ExitCode.USAGE)

    def test_a_journal_of_another_version_is_refused_with_what_to_do(self):
        old = {"version": 4, "identity": IDENTITY, "seconds": 1.0, "first_parts": 2, "next": 8, "parts": []}
        for document in (old, {**self.document, "version": VERSION + 1}, {"version": "five"}, {"version": None}):
            self.refused(document, "another version of polyrecon.*finish the frame with that version, or start again")

    def test_files_that_are_no_journal_are_refused(self):
        whole = json.dumps(self.document)
        for text in (
            "",
            "{",
            "\0",
            "[]",
            "3",
            "null",
            '"version"',
            "{}",
            whole[:-20],
            "[" * 100000,
            "nan",
            whole + "}",
        ):
            self.refused(text, "journal.json: not a valid journal: ")
        self.folder.journal.write_bytes(b'{"version": "\xff"}')
        with self.assertRaisesRegex(DriverError, "not a valid journal"):
            self.open()
        self.folder.journal.unlink()
        self.folder.journal.mkdir()
        with self.assertRaisesRegex(DriverError, "not a valid journal: is not a regular file"):
            self.open()

    def test_every_value_is_checked(self):
        """Each value of a journal in turn is missing, of a wrong type, negative, NaN, infinite or huge."""
        tried = 0
        for place in leaves(self.document):
            if not place or place[0] == "version" or (place[0] in ("identity", "inputs") and len(place) > 1):
                continue
            for value in WRONG_VALUES:
                in_list = isinstance(place[-1], int)
                if (in_list and value is MISSING) or any(value is v or value == v for v in ALLOWED.get(place[-1], ())):
                    continue
                with self.subTest(place=place, value="missing" if value is MISSING else value):
                    line = "is not the file" if "sha256" in f"{place[1:-1]}" or place[-1] == "sha256" else ""
                    self.refused(
                        with_value(self.document, place, value),
                        line if line and isinstance(value, str) else "not a valid journal: ",
                    )
                    tried += 1
        self.assertGreater(tried, 300)

    def test_values_that_contradict_each_other_are_refused(self):
        part, plan = self.document["parts"][2], self.document["next_round"]
        for place, value, line in (
            (("unknown",), 1, "unknown key 'unknown'"),
            (("a\nb",), 1, r"unknown key 'a\\nb'"),
            (("parts", 0, "spp"), 4.0, r"parts\[0\] has an unknown key 'spp'"),
            (("parts",), [*self.document["parts"], part], "two parts have the same file"),
            (("parts",), [*self.document["parts"], {**part, "file": "part_1a1.exr"}], "the same first_sample"),
            (("parts", 0, "file"), "../part_0a0.exr", "file does not match"),
            (("parts", 0, "file"), "part_0b7.exr", "file does not match"),
            (("parts", 0, "file"), "part_0a0.exr\n", "file does not match"),
            (("parts", 0, "half"), "c", "half is neither"),
            (("parts", 0, "masked"), True, "not uniform"),
            (("parts", 0, "samples"), 0, "not uniform"),
            (("parts", 0, "seconds"), 0, "seconds is not above 0"),
            (("parts", 2, "cost_weighted_samples"), 0, "cost_weighted_samples is not above 0"),
            (("next_sample",), 15, "first_sample is above next_sample"),
            (("first_pass_parts",), 0, "first_pass_parts"),
            (("first_pass_parts",), 3, "first_pass_parts"),
            (("rounds", 0, "round"), 1, "rounds are not numbered"),
            (("rounds",), [self.document["rounds"][0]] * 2, "rounds are not numbered"),
            (("next_round", "round"), 3, "does not follow"),
            (("next_round", "first_samples"), {"a": 1, "c": 2}, "does not name the halves"),
            (("next_round", "first_samples"), {"a": 1}, "does not name the halves"),
            (("next_round", "parts"), 0, "no parts"),
            (("next_round", "counts_sha256"), {"a": EMPTY}, "does not name the halves"),
            (("next_round",), {**plan, "cost_weighted_samples": 0}, "no samples"),
        ):
            with self.subTest(place=place, value=value):
                self.refused(with_value(self.document, place, value), line)

    def test_a_half_that_got_no_sample_may_share_a_number(self):
        empty = {**self.document["parts"][2], "file": "part_1b0.exr", "half": "b", "samples": 0.0, "masked": False}
        (self.folder.path / "part_1b0.exr").touch()
        self.write(with_value(self.document, ("parts",), [*self.document["parts"], empty]))
        self.assertEqual(len(self.open().state.parts), 4)

    def test_files_that_are_gone_are_named(self):
        for path in (self.folder.path / PARTS[1].file, self.folder.in_round(1, "counts_b")):
            path.unlink()
            self.refused(self.document, f"{path.name}: the journal names it", ExitCode.MISSING)
            path.touch()
        self.assertEqual(self.open().state.parts, PARTS)

    def test_swapped_files_are_named(self):
        """A part or counts of another frame, of the same size or not, a part under the name of another one, a link."""
        for path in (self.folder.path / PARTS[1].file, self.folder.in_round(1, "counts_b")):
            for content in (b"another", b"\0"):
                path.write_bytes(content)
                self.refused(self.document, f"{path.name}: is not the file that the journal names")
            path.unlink()
            os.mkfifo(path)
            self.refused(self.document, f"{path.name}: is not the file that the journal names")
            path.unlink()
            path.touch()
        self.assertEqual(self.open().state.parts, PARTS)

    def test_swapped_inputs_are_named(self):
        """A linked library that changed, is gone, or is new, cannot be averaged with the passes of the one before."""
        self.open().compare_inputs(dict(INPUTS))
        for inputs in ({**INPUTS, "/lib.blend": "3" * 64}, {"/a ä.blend": "1" * 64}, {**INPUTS, "/lib.blend2": ""}):
            with self.assertRaisesRegex(DriverError, "cannot continue: /lib.blend2? is not what it was") as caught:
                self.open().compare_inputs(inputs)
            self.assertEqual(caught.exception.code, ExitCode.USAGE)
        new = Journal(self.folder.journal, State({}))
        new.compare_inputs(dict(INPUTS))
        self.assertEqual(new.state.inputs, INPUTS)

    def test_an_error_without_finite_pixels_is_unknown(self):
        self.assertIsNone(self.open().state.error)
        state = dataclasses.replace(self.open().state, rounds=[dataclasses.replace(ROUNDS[0], error=0.5)])
        Journal(self.folder.journal, state).save()
        self.assertEqual(self.open().state.error, 0.5)


class CommandLine(unittest.TestCase):
    def test_damaged_journals_end_the_loop_with_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            synthetic.loop(folder, synthetic.Budget(samples=8), width=32, height=16)
            journal = Path(folder, "passes", "journal.json")
            good = json.loads(journal.read_text())
            other_size = Path(folder, "passes", "part_0a1.exr")
            content = other_size.read_bytes()
            exr.write(other_size, {name: np.zeros((4, 4)) for name in exr.read(other_size)})
            self.assert_refused(folder, "part_0a1.exr: is not the file that the journal names", ExitCode.BAD_INPUT)
            other_size.write_bytes(content)
            for place, value in ((("parts", 0, "seconds"), -1), (("version",), 4), (("parts", 0, "half"), MISSING)):
                journal.write_text(json.dumps(with_value(good, place, value)))
                self.assert_refused(folder, "journal.json: ", ExitCode.BAD_INPUT)

    def test_journal_tracebacks(self):
        """Random damage to the folder of passes: see journal_attacks.py."""
        found = journal_attacks.run(count=40, seed=5)
        self.assertEqual([what for what in found if what.startswith("wrong")], [])
        self.assertGreater(len(found), 2)

    def assert_refused(self, folder, text, code):
        with contextlib.redirect_stderr(io.StringIO()) as stderr:
            self.assertEqual(run_main("loop", synthetic.main, [folder, "16", "--resume"]), code)
        self.assertEqual(len(stderr.getvalue().splitlines()), 1, stderr.getvalue())
        self.assertIn(text, stderr.getvalue())


if __name__ == "__main__":
    unittest.main()
