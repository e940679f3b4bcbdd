"""The drivers and the Blender extension, which is installed without them, look for the program in the same places."""

import importlib.util
import os
import pathlib
import tempfile
import unittest
from unittest import mock

from pipelines.common.errors import DriverError
from pipelines.common.polyrecon_cli import find_polyrecon

ROOT = pathlib.Path(__file__).resolve().parents[3]


def extension_programs():
    path = ROOT / "pipelines" / "blender" / "extension" / "programs.py"
    spec = importlib.util.spec_from_file_location("programs", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Rule(unittest.TestCase):
    """`given` is --polyrecon, or the extension's preference."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()
        for name in ("given", "variable", "path/polyrecon", "path/other"):
            program = self.folder / name
            program.parent.mkdir(exist_ok=True)
            program.write_text("#!/bin/sh\n")
            program.chmod(0o755)
        (self.folder / "text").write_text("no program")
        self.programs = extension_programs()

    def found(self, given, variable, path="path"):
        environment = {"PATH": str(self.folder / path), "POLYRECON": variable}
        with mock.patch.dict(os.environ, environment):
            places = []
            for find, error in (
                (find_polyrecon, DriverError),
                (self.programs.find_program, self.programs.SetupError),
            ):
                try:
                    places.append(find(given))
                except error as problem:
                    places.append(str(problem).split(": ")[0])
        self.assertEqual(places[0], places[1], (given, variable))
        return places[0]

    def test_is_one(self):
        given, variable, on_path = (self.folder / name for name in ("given", "variable", "path/polyrecon"))
        self.assertEqual(self.found(str(given), str(variable)), given)
        self.assertEqual(self.found("", str(variable)), variable)
        self.assertEqual(self.found("", ""), on_path)
        self.assertEqual(self.found("other", str(variable)), self.folder / "path" / "other")  # a name
        self.assertEqual(self.found("", "other"), self.folder / "path" / "other")
        for wrong in ("no-such", str(self.folder), str(self.folder / "text"), str(self.folder / "none")):
            self.assertEqual(self.found(wrong, str(variable)), wrong)
            self.assertEqual(self.found("", wrong), wrong)

    def test_a_relative_path_becomes_absolute(self):
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)
        self.assertEqual(self.found("./given", ""), self.folder / "given")
