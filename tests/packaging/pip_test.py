#!/usr/bin/env python3
"""Installs package and drivers with pip, without the program, in a fresh environment:
pip_test.py SOURCE_FOLDER PROGRAM LIBRARY"""

import ast
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import venv

import tomllib

SOURCE, PROGRAM, LIBRARY = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
PACKAGE = SOURCE / "python" / "polyrecon"
PIPELINES = SOURCE / "pipelines"
PROJECT = tomllib.loads((SOURCE / "pyproject.toml").read_text())["project"]
GIVEN_BY_THE_RENDERER = {"_cycles", "bpy", "mathutils", "oslquery", "cycles"}
MODULES = {"yaml": "PyYAML"}


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def files_below(folder):
    return {path.relative_to(folder) for path in folder.rglob("*") if path.is_file() and path.suffix != ".pyc"}


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        environment = cls.folder / "environment"
        venv.create(environment, with_pip=True, system_site_packages=True)
        cls.bin = environment / "bin"
        # The dependencies are Debian's packages; test_what_is_imported_is_declared checks that pip knows them.
        run(
            *(cls.bin / "python3", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"),
            *("--config-settings=wheel.cmake=false", SOURCE),
        )

    def test_all_files_are_installed(self):
        code = "import pathlib, polyrecon_pipelines; print(pathlib.Path(polyrecon_pipelines.__file__).parent)"
        installed = pathlib.Path(run(self.bin / "python3", "-c", code).strip())
        self.assertTrue(installed.is_relative_to(self.folder), installed)
        self.assertEqual(files_below(installed), files_below(PIPELINES))

    def test_the_module_calls_the_library(self):
        code = f"""if True:
            import pathlib, polyrecon
            print(pathlib.Path(polyrecon.__file__).parent)
            render = polyrecon.read({str(SOURCE / "samples" / "study_small_0.exr")!r})
            assert polyrecon.denoise(render, quality="draft").image.shape == render["beauty"].shape"""
        environment = {**os.environ, "POLYRECON_LIBRARY": str(LIBRARY)}
        words = [self.bin / "python3", "-c", code]
        done = subprocess.run(words, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        installed = pathlib.Path(done.stdout.strip())
        self.assertTrue(installed.is_relative_to(self.folder), installed)
        self.assertEqual(files_below(installed), files_below(PACKAGE))
        environment["POLYRECON_LIBRARY"] = "/nowhere/libpolyrecon.so.1"
        done = subprocess.run(words, env=environment, capture_output=True, text=True)
        self.assertRegex(done.stderr, r"ImportError: libpolyrecon cannot be loaded \(.*libpolyrecon1")

    def test_every_command_has_help(self):
        self.assertTrue(PROJECT["scripts"])
        for command in PROJECT["scripts"]:
            self.assertIn("usage:", run(self.bin / command, "--help"))

    def test_the_version_is_the_program_s(self):
        self.assertEqual(run(PROGRAM, "--version").split(), ["polyrecon", PROJECT["version"]])

    def test_what_is_imported_is_declared(self):
        imported = set()
        for path in [*PIPELINES.rglob("*.py"), *PACKAGE.rglob("*.py")]:
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), path)):
                if isinstance(node, ast.Import):
                    imported |= {alias.name.split(".")[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and node.level == 0:
                    imported.add(node.module.split(".")[0])
        # Scripts that a renderer runs import each other, and folders, by these names.
        siblings = {name for path in PIPELINES.rglob("*.py") for name in (path.stem, path.parent.name)}
        ours = {"polyrecon_pipelines"}  # imported by the extension, which has them in its wheel
        foreign = imported - set(sys.stdlib_module_names) - GIVEN_BY_THE_RENDERER - siblings - ours
        self.assertLessEqual({MODULES.get(name, name) for name in foreign}, set(PROJECT["dependencies"]))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
