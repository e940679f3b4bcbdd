#!/usr/bin/env python3
"""Which tests are built depends on POLYRECON_TESTS, BUILD_TESTING and GoogleTest: configure_test.py SOURCE_FOLDER

The project is configured only, nothing is built.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(sys.argv[1]).resolve()
NO_GOOGLETEST = "-DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON"


class Configure(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        self.build = self.folder / "build"

    def configure(self, *words, source=SOURCE):
        done = subprocess.run(
            ["cmake", "-S", source, "-B", self.build, "-G", "Ninja", *words], capture_output=True, text=True
        )
        return done.returncode, " ".join((done.stdout + done.stderr).split())  # CMake wraps its messages

    def check_tests_are_built(self, built):
        listed = subprocess.run(
            ["ctest", "--test-dir", self.build, "--show-only=json-v1"], capture_output=True, text=True, check=True
        )
        self.assertEqual(bool(json.loads(listed.stdout)["tests"]), built)
        self.assertEqual("unit_tests" in (self.build / "build.ninja").read_text(), built)

    def test_tests_are_built_by_default(self):
        code, output = self.configure()
        self.assertEqual(code, 0, output)
        self.check_tests_are_built(True)

    def test_build_testing_off_leaves_the_tests_out(self):
        code, output = self.configure("-DBUILD_TESTING=OFF")
        self.assertEqual(code, 0, output)
        self.check_tests_are_built(False)

    def test_without_googletest_a_message_says_what_to_install(self):
        code, output = self.configure(NO_GOOGLETEST)
        self.assertEqual(code, 0, output)
        self.assertRegex(
            output, r"-- The tests are left out: GoogleTest .* was not found \(Debian package libgmock-dev\)"
        )
        self.check_tests_are_built(False)

    def test_googletest_without_googlemock_is_not_enough(self):
        (self.folder / "GTestConfig.cmake").write_text("add_library(GTest::gtest INTERFACE IMPORTED)\n")
        code, output = self.configure(f"-DGTest_DIR={self.folder}")
        self.assertEqual(code, 0, output)
        self.assertIn("-- The tests are left out: ", output)
        self.check_tests_are_built(False)

    def test_tests_asked_for_need_googletest_when_configured(self):
        code, output = self.configure(NO_GOOGLETEST, "-DPOLYRECON_TESTS=ON")
        self.assertNotEqual(code, 0)
        self.assertRegex(output, r"POLYRECON_TESTS is ON, but GoogleTest .* \(Debian package libgmock-dev\)")
        self.assertFalse((self.build / "build.ninja").exists())

    def test_a_project_that_contains_this_one_gets_the_library_without_tests(self):
        outer = self.folder / "outer"
        outer.mkdir()
        (outer / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(outer LANGUAGES CXX)\n"
            f"add_subdirectory({SOURCE} polyrecon)\nadd_library(user INTERFACE)\n"
            "target_link_libraries(user INTERFACE polyrecon::core)\n"
        )
        code, output = self.configure(source=outer)
        self.assertEqual(code, 0, output)
        self.check_tests_are_built(False)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
