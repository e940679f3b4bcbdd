"""The examples of docs/guide/library.md: the program in C, Mitsuba, and the notebook."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "docs" / "guide" / "examples"
PROGRAM = os.environ["POLYRECON"]
LIBRARY = pathlib.Path(os.environ["POLYRECON_LIBRARY"])
SAMPLES = pathlib.Path(os.environ["POLYRECON_SAMPLES"])
SMALL = SAMPLES / "study_small_0.exr"


def run(*words, folder):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, cwd=folder)
    if done.returncode:
        raise AssertionError(f"{words}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Examples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_the_program_in_c_makes_the_file_of_the_program(self):
        """Built as C99 with all warnings, so the header is C too."""
        strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wstrict-prototypes", "-Werror"]
        library = [LIBRARY, f"-Wl,-rpath,{LIBRARY.parent}"]
        words = ["cc", *strict, f"-I{ROOT / 'include'}", EXAMPLES / "denoise.c", "-o", "denoise", *library]
        run(*words, folder=self.folder)
        ours, theirs = self.folder / "ours.exr", self.folder / "theirs.exr"
        printed = run(self.folder / "denoise", SMALL, ours, folder=self.folder)
        self.assertIn("polynomials", printed)
        run(PROGRAM, "denoise", "-q", "-i", SMALL, "-o", theirs, folder=self.folder)
        run("/usr/bin/oiiotool", "-a", "--fail", "0", "--hardfail", "0", ours, theirs, "--diff", folder=self.folder)
        failed = subprocess.run([self.folder / "denoise", "missing.exr", ours], capture_output=True, text=True)
        self.assertEqual(failed.returncode, 4)
        self.assertRegex(failed.stderr, r"\Adenoise: missing\.exr: .*\n\Z")

    def test_mitsuba(self):
        words = ["--samples", "32", "--size", "64", "--reference", "1024"]
        printed = run(sys.executable, EXAMPLES / "denoise_mitsuba.py", *words, folder=self.folder)
        before, after, estimated = (float(number) for number in re.findall(r": +([\d.e-]+)$", printed, re.M))
        self.assertLess(after, before / 2, printed)
        self.assertGreater(after, 0)
        self.assertLess(max(after / estimated, estimated / after), 4, printed)
        self.assertTrue((self.folder / "clean.exr").is_file())

    def test_the_notebook(self):
        printed = run(sys.executable, EXAMPLES / "notebook.py", SAMPLES, folder=self.folder)
        before, after = (float(n) for n in re.search(r"relMSE ([\d.]+) -> ([\d.]+)", printed).groups())
        self.assertLess(after, before / 2, printed)
        self.assertTrue((self.folder / "clean.exr").is_file())


if __name__ == "__main__":
    unittest.main()
