"""docs/dev/release.md names every file of program and drivers that calls the operating system other than through the
standard libraries, and vcpkg's manifest has a port for every library that CMake looks for."""

import json
import re
import unittest

from . import tree

HEADERS = re.compile(r"#include <(?:dlfcn|fcntl|unistd|sched|termios|pthread|sys/\w+)\.h>")
CALLS = re.compile(r"import (?:fcntl|resource|pwd|termios)\b|killpg|sched_getaffinity|\bsyscall\(|\"/proc")
PORTS = {"CLI11": "cli11", "OpenColorIO": "opencolorio", "Eigen3": "eigen3", "nlohmann_json": "nlohmann-json"}


class ReleasePage(unittest.TestCase):
    def test_table_holds_the_files_for_linux_alone(self):
        found = set()
        for path in tree.files():
            words = CALLS if path.suffix == ".py" else HEADERS
            if path.parts[0] in ("src", "pipelines", "python") and path.suffix in (".cpp", ".h", ".py"):
                found |= {str(path)} if words.search(tree.read(path)) else set()
        self.assertIn("src/module/load_pictures.cpp", found)
        rows = tree.table(tree.read("docs/dev/release.md"), "file for Linux alone")
        named = {name for row in rows for name in re.findall(r"`([^`]+)`", row[0])}
        self.assertLessEqual(found, named)
        self.assertLessEqual({name for name in named if name.endswith((".cpp", ".py"))}, found)

    def test_manifest_has_every_library(self):
        text = tree.read("src/polyreconDependencies.cmake") + tree.read("CMakeLists.txt")
        names = set(re.findall(r"(?:find_package|pkg_check_modules)\((\w+)", text)) - {"PkgConfig", "GTest"}
        manifest = json.loads(tree.read("src/package/wheel/vcpkg.json"))
        ports = {port if isinstance(port, str) else port["name"] for port in manifest["dependencies"]}
        self.assertEqual({PORTS.get(name, name.lower()) for name in names} | {"imath"}, ports)


if __name__ == "__main__":
    unittest.main()
