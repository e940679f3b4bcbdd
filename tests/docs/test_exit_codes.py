"""docs/reference/exit_codes.md, the codes of library and program, the drivers' enum and `polyrecon --help` agree."""

import os
import re
import subprocess
import unittest

from pipelines.common.errors import ExitCode

from . import tree


def documented():
    return {
        int(code): name.strip("`") for code, name, *_ in tree.table(tree.read("docs/reference/exit_codes.md"), "code")
    }


class ExitCodes(unittest.TestCase):
    def test_names_and_numbers_are_those_of_library_and_program(self):
        enum = re.search(r"enum class ExitCode \{(.*?)\};", tree.read("include/polyrecon/error.h"), re.S)[1]
        codes = {int(code): name for name, code in re.findall(r"(\w+) = (\d+)", enum)}
        self.assertGreater(len(codes), 5)
        # A missed target is no error of the library: the program has a code for it.
        missed = int(re.search(r"exit_code_missed = (\d+)", tree.read("src/cli/commands.h"))[1])
        self.assertNotIn(missed, codes)
        self.assertEqual(codes | {missed: "Missed"}, documented())

    def test_numbers_are_those_of_the_drivers(self):
        self.assertEqual({int(code) for code in ExitCode}, set(documented()))

    def test_numbers_are_those_of_the_help(self):
        text = subprocess.run([os.environ["POLYRECON"], "--help"], capture_output=True, text=True, check=True).stdout
        listed = re.findall(r"^  ((?:\d+, )*\d+)  ", text, re.M)
        self.assertEqual(sorted(documented()), sorted(int(code) for codes in listed for code in codes.split(", ")))


if __name__ == "__main__":
    unittest.main()
