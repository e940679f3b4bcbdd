"""A test for every driver of the loop whose passes do not depend on the time that they take."""

import json
import subprocess
import time

import numpy as np

from pipelines.common import exr


def check_killed_and_resumed(test, command, folder, environment=None):
    """A run that is killed between the parts of a round and then continued has the bits of a run that was not.

    test: a unittest.TestCase. command(output): the words that start the driver on `output`, with --keep-passes and a
    budget of samples that is enough for a round. folder: an empty one."""
    whole, broken = folder / "whole.exr", folder / "broken.exr"
    _run(test, command(whole), environment)
    _run_until(test, command(broken), environment, _passes(broken) / "part_1a0.exr")
    killed = _parts(broken)
    _run(test, [*command(broken), "--resume"], environment)
    parts = _parts(broken)
    test.assertLess(len(killed), len(parts), "it was killed after its last part")
    test.assertEqual(parts, _parts(whole))
    for a, b in ((whole, broken), (_passes(whole) / "merged.exr", _passes(broken) / "merged.exr")):
        expected, found = exr.read(a), exr.read(b)
        test.assertEqual(expected.keys(), found.keys())
        for name in expected:
            np.testing.assert_array_equal(expected[name], found[name], f"{b.name}: {name}")


def _passes(output):
    return output.with_suffix(".passes")


def _parts(output):
    """The finished parts by the journal, but for their times and the digests of files that hold times."""
    parts = json.loads((_passes(output) / "journal.json").read_text())["parts"]
    return [[part[key] for key in ("file", "first_sample", "samples", "masked")] for part in parts]


def _run(test, words, environment):
    done = subprocess.run(words, env=environment, capture_output=True, text=True)
    test.assertEqual(0, done.returncode, done.stderr)


def _run_until(test, words, environment, file):
    """Kills the driver where the file is there."""
    child = subprocess.Popen(words, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while not file.exists():
            test.assertIsNone(child.poll(), f"it ended without {file.name}")
            time.sleep(0.002)
    finally:
        child.kill()
        child.wait()
