"""Every relative link and picture of every page exists, every anchor exists, and so does every file of the tree that a
page or a comment names."""

import pathlib
import re
import unittest
import urllib.parse

from . import tree

LINK = re.compile(r"!?\[(?:[^\]\\]|\\.)*\]\(<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\)")
DEFINITION = re.compile(r"^\[[^\]]+\]:\s*(\S+)", re.M)
HTML = re.compile(r"<(?:img|a|source)\s[^>]*?(?:src|href|srcset)=\"([^\"]+)\"")
NAMED = re.compile(r"(?<![\w/.$}>-])(?:docs|include|pipelines|samples|src|tests)/[\w./*-]*\w[*/]?")
FILE = re.compile(r"(?<![\w/.$}<>#-])(?:[\w-]+/)+[\w-]+\.(?:h|cpp|py|md|cmake)\b")
FROZEN = (pathlib.Path("docs/lab"), pathlib.Path("CHANGELOG.md"))  # they speak of the tree of their day
RECIPE = "docs/dev/add_a_"  # such pages name files that the reader makes:
MADE = re.compile(r"NAME|stub|curvature_test|denoisers/|denoiser_test", re.IGNORECASE)


def links(text):
    text = re.sub(r"<!--.*?-->", lambda comment: "\n" * comment[0].count("\n"), tree.without_code(text), flags=re.S)
    return [found for pattern in (LINK, DEFINITION, HTML) for found in pattern.findall(text)]


def fault_of_link(page, target):
    """The fault of a link of a page, or None."""
    if re.match(r"[a-z][a-z+.-]*:", target):
        return None  # of another site, which no test should depend on
    path, _, anchor = urllib.parse.unquote(target).partition("#")
    found = (tree.ROOT / page.parent / path).resolve() if path else tree.ROOT / page
    if not found.is_relative_to(tree.ROOT) or not found.exists():
        return f"{target}: no such file"
    if anchor and found.suffix == ".md" and anchor not in tree.anchors(found.read_text(encoding="utf-8")):
        return f"{target}: no such heading"
    return None


def exists(name, folders):
    """Whether some folder has the file; `blend/select` stands for select.h and select.cpp."""
    patterns = [name] if "." in name else [name, f"{name}.*"]
    return any(next(folder.glob(pattern), None) is not None for folder in folders for pattern in patterns)


def faults_of_paths(path):
    """Paths of the tree that a page's lines or a source's comments name and that do not exist."""
    # `core/tiles.h` is below src/, `loop/counts.py` below pipelines/.
    near = [tree.ROOT, *(tree.ROOT / folder for folder in ("src", "include", "tests", "pipelines"))]
    near += [tree.ROOT / path.parent, tree.ROOT / path.parent.parent]
    faults = []
    for number, text in tree.comments(path):
        named = {name for name in NAMED.findall(text) + FILE.findall(text) if not name.startswith("build/")}
        if str(path).startswith(RECIPE):
            named = {name for name in named if not MADE.search(name)}
        missing = {name for name in named if not exists(name.rstrip("/"), near)}
        faults += [f"{path}:{number}: {name}: no such file" for name in sorted(missing)]
    return faults


def is_frozen(path):
    return any(frozen == path or frozen in path.parents for frozen in FROZEN)


class Links(unittest.TestCase):
    def test_links_pictures_and_anchors_exist(self):
        faults, count = [], 0
        for page in tree.pages():
            for target in links(tree.read(page)):
                count += 1
                if fault := fault_of_link(page, target):
                    faults.append(f"{page}: {fault}")
        self.assertEqual([], faults, "\n" + "\n".join(faults))
        self.assertGreater(count, 30)

    def test_paths_in_pages_and_comments_exist(self):
        faults = [fault for path in tree.files() if not is_frozen(path) for fault in faults_of_paths(path)]
        self.assertEqual([], faults, "\n" + "\n".join(faults))


class TheCheckItself(unittest.TestCase):
    """On text whose faults are known."""

    def test_finds_links_outside_of_code_only(self):
        text = '[a](b.md) ![c](d.png "title")\n\n    [code](e.md)\n\n`[span](f.md)`\n```\n[fence](g.md)\n```\n[h]: i.md'
        self.assertEqual(["b.md", "d.png", "i.md"], links(text))

    def test_anchors_are_those_of_github(self):
        text = "# A `b`, c's\n## Twice\n## Twice\n```\n# no heading\n```\n### [link](x.md) (d)"
        self.assertEqual({"a-b-cs", "twice", "twice-1", "link-d"}, tree.anchors(text))

    def test_refuses_what_is_not_there(self):
        page = pathlib.Path("README.md")
        self.assertIsNone(fault_of_link(page, "LICENSE"))
        self.assertIsNone(fault_of_link(page, "https://example.org/none"))
        self.assertEqual("none.md: no such file", fault_of_link(page, "none.md"))
        self.assertEqual("#none: no such heading", fault_of_link(page, "#none"))
        self.assertIn("no such file", fault_of_link(page, "../../etc"))

    def test_finds_paths_in_comments(self):
        found = NAMED.findall(
            "see include/polyrecon/error.h, `tests/run.sh`. build/dev/src/polyrecon and tests/docs/*.py"
        )
        self.assertEqual(["include/polyrecon/error.h", "tests/run.sh", "tests/docs/*.py"], found)
        self.assertEqual([(1, "// a/b.h")], list(tree.line_comments("// a/b.h\nint x;", "//")))


if __name__ == "__main__":
    unittest.main()
