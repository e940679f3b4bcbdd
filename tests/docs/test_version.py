"""The version is the same in every file that docs/dev/release.md names."""

import re
import unittest

from . import tree

PATTERNS = {
    "CMakeLists.txt": r"project\(polyrecon VERSION ([\d.]+)",
    "pyproject.toml": r'^version = "([\d.]+)"',
    "pipelines/common/version.py": r'^VERSION = "([\d.]+)"',
    "pipelines/blender/extension/blender_manifest.toml": r'^version = "([\d.]+)"',
    "src/package/changelog": r"\Apolyrecon \(([\d.]+)\)",
}


class Version(unittest.TestCase):
    def test_is_the_same_everywhere(self):
        found = {file: re.search(pattern, tree.read(file), flags=re.M)[1] for file, pattern in PATTERNS.items()}
        self.assertEqual(len(set(found.values())), 1, found)

    def test_the_page_lists_the_files(self):
        page = tree.read("docs/dev/release.md")
        for file in PATTERNS:
            self.assertIn(f"| `{file}`", page)


if __name__ == "__main__":
    unittest.main()
