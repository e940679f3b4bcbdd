"""docs/dev/add_a_feature_pass.md, add_a_renderer.md and add_a_denoiser.md, followed to the letter on a copy of the
tree: what they edit is there, and every source that they make or change compiles.

    New file `PATH`:                        the code block is the file
    At the end of `PATH`, ...:              ... its last lines
    In `PATH`, behind `TEXT`:               ... lines behind the one that begins with TEXT; "in front of" likewise
    In `PATH`, in place of `TEXT`:          ... in place of that text

What can be added again is followed twice, under a second name: the first edits must leave the places of the next.
"""

import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest

from . import tree

STEP = re.compile(
    r"(?:(?P<new>New file)|(?P<end>At the end of)|In) `(?P<path>[\w/.]+)`"
    r"(?:, (?P<where>behind|in front of|in place of) (?P<ticks>`+)(?P<text>.+?)(?P=ticks)|[^`]*?)?:\n\n"
    r"```\w+\n(?P<code>.*?)```",
    re.S,
)
# Files of a folder are compiled with the options of a target. In a unity build they have no commands of their own.
TARGETS = (("src/", "polyrecon_numeric"), ("tests/cli/", "program_tests"), ("tests/", "unit_tests"))


def renamed(text, names):
    for name, other in names.items():
        text = text.replace(name, other).replace(name.capitalize(), other.capitalize())
    return text


def follow(page, root, names):
    """Makes the page's edits below root with other names. Returns the paths that were edited, without repetition."""
    paths = {}
    for step in STEP.finditer(renamed(tree.read(page), names)):
        path, code = root / step["path"], step["code"]
        paths[step["path"]] = None
        if step["new"]:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(code, encoding="utf-8")
        else:
            before = path.read_text(encoding="utf-8")
            path.write_text(edited(before, step, f"{page}: {step['path']}"), encoding="utf-8")
    return list(paths)


def edited(before, step, name):
    if step["end"]:
        return before + step["code"]
    text = step["text"]
    if step["where"] == "in place of":
        if before.count(text) != 1:
            raise AssertionError(f"{name} has {before.count(text)} times: {text}")
        return before.replace(text, step["code"].rstrip("\n"))
    lines = before.splitlines(keepends=True)
    found = [number for number, line in enumerate(lines) if line.strip().startswith(text)]
    if len(found) != 1:
        raise AssertionError(f"{name} has {len(found)} lines that begin with: {text}")
    at = found[0] + (step["where"] == "behind")
    return "".join([*lines[:at], step["code"], *lines[at:]])


def commands(build):
    """A command of each target."""
    found = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    targets = ((re.search(r" -o \S*CMakeFiles/(\w+)\.dir/\S+\.o ", entry["command"]), entry) for entry in found)
    return {target[1]: entry["command"] for target, entry in targets if target}


def errors_of(path, root, known):
    """The compiler's messages about a file below root, with the options of the build."""
    words, kept = shlex.split(known[next(target for folder, target in TARGETS if path.startswith(folder))]), []
    while words:
        word = words.pop(0)
        if word in ("-o", "-c", "-include"):  # The precompiled header would be made of the tree's own headers.
            words.pop(0)
        elif word != "-Winvalid-pch":
            kept.append(re.sub(rf"^-I{re.escape(str(tree.ROOT))}/(?=include|src|tests)", f"-I{root}/", word))
    done = subprocess.run([*kept, "-fsyntax-only", root / path], capture_output=True, text=True)
    return done.stderr if done.returncode else ""


class Recipes(unittest.TestCase):
    def check(self, page, again=None):
        build = pathlib.Path(os.environ["POLYRECON_BUILD"])
        if not (build / "compile_commands.json").exists():
            self.skipTest("CMAKE_EXPORT_COMPILE_COMMANDS is off")
        known = commands(build)
        text = tree.read(page)
        self.assertEqual(text.count("\n```"), 2 * len(STEP.findall(text)), "a code block that no sentence places")
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in ("docs", "include", "src", "tests"):
                shutil.copytree(tree.ROOT / name, root / name, ignore=shutil.ignore_patterns("corpus", "__pycache__"))
            paths = follow(page, root, {})
            if again:
                paths = dict.fromkeys([*paths, *follow(page, root, again)])
            sources = [path for path in paths if path.endswith(".cpp")]
            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
                for path, errors in zip(sources, pool.map(lambda path: errors_of(path, root, known), sources)):
                    self.assertEqual("", errors, path)

    def test_a_feature_pass(self):
        self.check("docs/dev/add_a_feature_pass.md", {"curvature": "thickness"})

    def test_a_renderer(self):
        self.check("docs/dev/add_a_renderer.md", {"stub": "second"})

    def test_a_denoiser(self):
        self.check("docs/dev/add_a_denoiser.md", {"stub": "second"})


class TheCheckItself(unittest.TestCase):
    def test_an_edit_whose_place_is_gone_or_ambiguous_fails(self):
        page = "In `a.cpp`, behind `one;`:\n\n```cpp\ntwo;\n```\n"
        step = STEP.search(page)
        self.assertEqual("one;\ntwo;\nthree;\n", edited("one;\nthree;\n", step, ""))
        for text in ("none;\n", "one;\none;\n"):
            with self.assertRaisesRegex(AssertionError, "lines that begin with: one;"):
                edited(text, step, "")


if __name__ == "__main__":
    unittest.main()
