#!/usr/bin/env python3
"""Reads how the built files are hardened: hardening_test.py ARCHIVE PROGRAM MODULE LIBRARY

The objects of ARCHIVE are in PROGRAM and LIBRARY.
"""

import pathlib
import platform
import re
import subprocess
import sys
import unittest

ARCHIVE, PROGRAM, MODULE, LIBRARY = sys.argv[1:5]


def readelf(*words):
    return subprocess.run(["readelf", "--wide", *words], capture_output=True, text=True, check=True).stdout


class Hardening(unittest.TestCase):
    def each(self):
        for path in (PROGRAM, MODULE, LIBRARY):
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

    def test_stacks_are_checked(self):
        for path in self.each():
            self.assertRegex(readelf("--dyn-syms", path), r"UND __stack_chk_fail@")

    def test_copies_are_checked(self):
        self.assertRegex(readelf("--dyn-syms", PROGRAM), r"UND __\w+_chk@")

    @unittest.skipUnless(platform.machine() == "x86_64", "a feature of x86")
    def test_jumps_end_at_marked_places(self):
        # The linker marks a program only if the first objects of the C library are marked, which Debian 12's are not.
        objects = readelf("--notes", ARCHIVE).split("\nFile: ")[1:]
        members = subprocess.run(["ar", "t", ARCHIVE], capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(len(objects), len(members))
        for notes in objects:
            self.assertRegex(notes, r"x86 feature: IBT, SHSTK", notes.splitlines()[0])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
