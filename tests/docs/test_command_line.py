"""docs/reference/command_line.md is what the command line's options say today."""

import difflib
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from pipelines.common import denoise_defaults

from . import tree

PAGE = pathlib.Path("docs/reference/command_line.md")
UPDATE = "cmake --build --preset dev --target command_line_page"


class CommandLine(unittest.TestCase):
    def test_page_is_up_to_date(self):
        with tempfile.TemporaryDirectory() as folder:
            fresh = pathlib.Path(folder, "page.md")
            subprocess.run([os.environ["POLYRECON_MANUAL"], "--markdown", fresh], check=True)
            written = fresh.read_text(encoding="utf-8").splitlines()
        change = "\n".join(
            difflib.unified_diff(tree.read(PAGE).splitlines(), written, str(PAGE), "the program", lineterm="")
        )
        if change:
            self.fail(f"{PAGE} is stale. Update it with `{UPDATE}` and commit it. What differs:\n{change}")

    def test_drivers_know_choices_and_defaults(self):
        page = tree.read(PAGE)
        self.assertEqual(list(denoise_defaults.QUALITIES), re.search(r"\| `--quality` `([^`]+)`", page)[1].split("\\|"))
        self.assertIn(denoise_defaults.DEFAULT_QUALITY, denoise_defaults.QUALITIES)
        self.assertEqual(list(denoise_defaults.ON_MISS), re.search(r"\| `--on-miss` `([^`]+)`", page)[1].split("\\|"))
        self.assertIn(f"(default {denoise_defaults.ON_MISS[0]})", re.search(r"\| `--on-miss` .*", page)[0])
        self.assertIn(f"(default {denoise_defaults.DEFAULT_OUTPUTS})", re.search(r"\| `--outputs` .*", page)[0])
        radius = re.search(r"\| `--frame-radius` .*; default: (\d+)", page)[1]
        self.assertEqual(denoise_defaults.DEFAULT_FRAME_RADIUS, int(radius))

    def test_the_list_of_all_steps_but_fireflies(self):
        steps = re.search(r"`--steps`.* or a list of ([\w,-]+)", tree.read(PAGE))[1].split(",")
        steps.remove("fireflies")
        self.assertIn(
            f"name all steps but `fireflies`:\n  `--steps {','.join(steps)}`",
            tree.read("docs/guide/troubleshooting.md"),
        )


if __name__ == "__main__":
    unittest.main()
