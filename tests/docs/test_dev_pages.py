"""docs/dev against the tree: the files that notation.md names exist and hold the identifiers, the table of folders in
architecture.md has every folder of src/, no folders of src/ include each other, and the figure is what its script
draws."""

import re
import subprocess
import sys
import unittest

from . import tree


class Notation(unittest.TestCase):
    def test_identifiers_are_in_the_files_named(self):
        sections = re.split(r"^## ", tree.read("docs/dev/notation.md"), flags=re.M)
        rows = [row for text in sections for heading in ("step", "symbol") for row in tree.table(text, heading)]
        self.assertGreater(len(rows), 50)
        for symbol, _, identifiers, files, *_ in rows:
            paths = [tree.ROOT / path for path in re.findall(r"`([^`]+)`", files)]
            missing = [str(path) for path in paths if not path.exists()]
            self.assertEqual([], missing, symbol)
            text = "".join(path.read_text(encoding="utf-8") for path in paths if path.is_file())
            for identifier in re.findall(r"`([^`]+)`", identifiers):
                for word in re.findall(r"[A-Za-z_]\w+", identifier):
                    self.assertRegex(text, rf"\b{word}\b", f"{symbol}: {word} is not in {files}")


class Architecture(unittest.TestCase):
    def test_every_folder_has_a_row(self):
        rows = tree.table(tree.read("docs/dev/architecture.md"), "folder")
        named = [path for row in rows for path in re.findall(r"`(\w[\w/]*)/`", row[0])]
        folders = {str(path.parent) for path in tree.files() if path.parts[0] in ("src", "include")}
        self.assertEqual(sorted(folders), sorted(named))

    def test_no_cycles_between_the_folders_of_src(self):
        includes = {}
        for path in tree.files():
            if path.parts[0] == "src" and path.suffix in (".h", ".cpp"):
                found = re.findall(r"#include \"(\w+)/", tree.read(path))
                includes.setdefault(path.parts[1], set()).update(found)
        self.assertIn("core", includes["regression"])
        while includes:
            leaves = [folder for folder, others in includes.items() if not (others - {folder}) & includes.keys()]
            self.assertTrue(leaves, f"cycle among {sorted(includes)}")
            for folder in leaves:
                del includes[folder]

    def test_public_headers_include_no_private_ones(self):
        headers = sorted((tree.ROOT / "include" / "polyrecon").glob("*.h"))
        self.assertGreater(len(headers), 5)
        for header in headers:
            for included in re.findall(r"#include \"([^\"]+)\"", header.read_text(encoding="utf-8")):
                self.assertTrue((tree.ROOT / "include" / included).is_file(), f"{header.name}: {included}")

    def test_figure_is_what_its_script_draws(self):
        script = tree.ROOT / "docs" / "dev" / "data_flow.py"
        drawn = subprocess.run([sys.executable, "-B", script], capture_output=True, text=True, check=True).stdout
        self.assertEqual(drawn, tree.read("docs/dev/data_flow.svg"), f"draw it again: {script.name} > data_flow.svg")

    def test_figure_names_functions_of_the_folders(self):
        text = tree.read("docs/dev/data_flow.svg")
        boxes = re.findall(r">([^<]+)</text>\n<text class=\"folder\"[^>]*>(src/[^<]+)</text>", text)
        self.assertGreater(len(boxes), 10)
        for functions, folders in boxes:
            paths = [
                path for folder in re.findall(r"src/\w+", folders) for path in (tree.ROOT / folder).rglob("*.[hc]*")
            ]
            sources = "".join(path.read_text(encoding="utf-8") for path in paths)
            for function in re.findall(r"\b[a-z]+_[a-z_]+\b", functions):
                self.assertRegex(sources, rf"\b{function}\(", f"{function} is not in {folders}")


if __name__ == "__main__":
    unittest.main()
