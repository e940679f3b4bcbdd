#!/usr/bin/env python3
"""Reads how the built files are hardened: hardening_test.py PROGRAM MODULE"""

import pathlib
import re
import subprocess
import sys
import unittest

PROGRAM, MODULE = sys.argv[1:3]


def readelf(*words):
    return subprocess.run(["readelf", "--wide", *words], capture_output=True, text=True, check=True).stdout


class Hardening(unittest.TestCase):
    def each(self):
        for path in (PROGRAM, MODULE):
            with self.subTest(pathlib.Path(path).name):
                yield path

    def test_addresses_are_random(self):
        self.assertIn("(Position-Independent Executable file)", readelf("--file-header", PROGRAM))
        self.assertRegex(readelf("--dynamic", PROGRAM), r"\(FLAGS_1\).*\bPIE\b")

    def test_tables_of_functions_are_read_only_before_main(self):
        for path in self.each():
            self.assertIn("GNU_RELRO", readelf("--program-headers", path))
            self.assertRegex(readelf("--dynamic", path), r"\(FLAGS_1\).*\bNOW\b")

    def test_no_data_is_executable(self):
        for path in self.each():
            rows = readelf("--program-headers", path).splitlines()
            flags = [
                match.groups()
                for match in map(re.compile(r"\s+(LOAD|GNU_STACK) .* ([R ][W ][E ]) 0x").match, rows)
                if match
            ]
            self.assertIn(("GNU_STACK", "RW "), flags)
            self.assertGreater(len(flags), 3)
            self.assertEqual([flag for _, flag in flags if "W" in flag and "E" in flag], [])
            self.assertNotIn("TEXTREL", readelf("--dynamic", path))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
