"""Where the drivers, and with them the Blender extension, look for the program."""

import os
import pathlib
import tempfile
import unittest
from unittest import mock

from pipelines.common import polyrecon_cli
from pipelines.common.errors import DriverError
from pipelines.common.polyrecon_cli import find_polyrecon


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

    def found(self, given, variable, path="path"):
        environment = {"PATH": str(self.folder / path), "POLYRECON": variable}
        with mock.patch.dict(os.environ, environment):
            try:
                return find_polyrecon(given)
            except DriverError as problem:
                return str(problem).split(": ")[0]

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

    def test_the_program_that_was_installed_with_the_drivers_comes_before_the_path(self):
        module = self.folder / "site" / "polyrecon_pipelines" / "common" / "polyrecon_cli.py"
        program = self.folder / "site" / "polyrecon" / "bin" / "polyrecon"
        program.parent.mkdir(parents=True)
        program.write_text("#!/bin/sh\n")
        with mock.patch.object(polyrecon_cli, "__file__", str(module)):
            self.assertEqual(self.found("", ""), self.folder / "path" / "polyrecon")  # It may not be executed yet.
            program.chmod(0o755)
            self.assertEqual(self.found("", ""), program)
            self.assertEqual(self.found("", str(self.folder / "variable")), self.folder / "variable")


if __name__ == "__main__":
    unittest.main()
