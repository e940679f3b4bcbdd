#!/usr/bin/env python3
"""What libpolyrecon.so shows to others: library_test.py LIBRARY SOURCE_FOLDER"""

import pathlib
import re
import subprocess
import sys
import unittest

LIBRARY, SOURCE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
HEADER = (SOURCE / "include" / "polyrecon" / "polyrecon.h").read_text()
# The symbols of each version. Programs were linked with them, so lines are added here and never changed.
SYMBOLS = {
    "POLYRECON_1.0": [
        "polyrecon_describe_image",
        "polyrecon_execute",
        "polyrecon_get_error",
        "polyrecon_get_image",
        "polyrecon_get_report",
        "polyrecon_image_count",
        "polyrecon_image_name",
        "polyrecon_new_filter",
        "polyrecon_release_filter",
        "polyrecon_set_image",
        "polyrecon_set_number",
        "polyrecon_set_progress",
        "polyrecon_set_text",
        "polyrecon_version",
    ]
}
# Types and numbers of the header that compiled programs contain, on 64-bit Linux.
LAYOUT = """
#include <polyrecon/polyrecon.h>
#define SAME(name, a, b) typedef char name[(a) == (b) ? 1 : -1]
SAME(size, sizeof(polyrecon_image), 48);
SAME(data, offsetof(polyrecon_image, data), 0);
SAME(format, offsetof(polyrecon_image, format), 8);
SAME(width, offsetof(polyrecon_image, width), 12);
SAME(height, offsetof(polyrecon_image, height), 16);
SAME(channels, offsetof(polyrecon_image, channels), 20);
SAME(channel_stride, offsetof(polyrecon_image, channel_stride), 24);
SAME(pixel_stride, offsetof(polyrecon_image, pixel_stride), 32);
SAME(row_stride, offsetof(polyrecon_image, row_stride), 40);
SAME(floats, POLYRECON_FLOAT, 1);
SAME(halves, POLYRECON_HALF, 2);
SAME(interrupted, POLYRECON_INTERRUPTED, 130);
SAME(memory, POLYRECON_OUT_OF_MEMORY, 33);
"""


class Symbols(unittest.TestCase):
    def test_they_are_those_of_the_list_and_no_others(self):
        words = ["nm", "--dynamic", "--defined-only", "--with-symbol-versions", LIBRARY]
        lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout.split("\n")
        shown = sorted(line.split()[2] for line in lines if line and line.split()[1] != "A")
        self.assertEqual(shown, sorted(f"{name}@@{version}" for version in SYMBOLS for name in SYMBOLS[version]))

    def test_they_are_those_of_the_header(self):
        declared = re.findall(r"POLYRECON_API [\w\s*]*?\b(polyrecon_\w+)\(", HEADER)
        self.assertEqual(sorted(declared), sorted(name for names in SYMBOLS.values() for name in names))

    def test_types_have_the_layout_that_programs_contain(self):
        words = ["cc", "-std=c99", "-fsyntax-only", f"-I{SOURCE / 'include'}", "-x", "c", "-"]
        done = subprocess.run(words, input=LAYOUT, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_its_name_holds_its_version(self):
        dynamic = subprocess.run(["readelf", "--dynamic", LIBRARY], capture_output=True, text=True, check=True).stdout
        self.assertIn("Library soname: [libpolyrecon.so.1]", dynamic)
        self.assertNotIn("libOpenImageIO.so", dynamic, "some 200 libraries that only pictures need are loaded")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
