"""docs/dev/add_a_driver.md, followed to the letter on a copy of the tree: its code blocks become files, and the test
that it adds passes."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from . import tree

BLOCK = re.compile(r"`([\w/]+\.py)`:\n\n```python\n(.*?)```", re.S)


class Recipe(unittest.TestCase):
    def test_the_driver_of_the_page_runs(self):
        files = BLOCK.findall(tree.read("docs/dev/add_a_driver.md"))
        self.assertEqual(4, len(files))
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in ("pipelines", "tests/pipelines"):
                shutil.copytree(tree.ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
            (root / "tests" / "__init__.py").touch()
            for name, text in files:
                path = root / name
                path.parent.mkdir(exist_ok=True)
                (path.parent / "__init__.py").touch()
                path.write_text(text, encoding="utf-8")
            command = [sys.executable, "-B", "-m", "unittest", "tests.pipelines.stub.test_adaptive"]
            environment = {**os.environ, "POLYRECON": os.path.abspath(os.environ["POLYRECON"])}
            done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
            self.assertEqual(0, done.returncode, done.stderr)
            self.assertIn("Ran 4 tests", done.stderr)


if __name__ == "__main__":
    unittest.main()
