"""The tables that name drivers: the guide's commands are those of pyproject.toml, pipelines/README.md has a row for
every folder."""

import re
import unittest

from pipelines.common import layer_names

from . import tree


def column_of_code(page, heading):
    return [[cell.strip("`") for cell in row] for row in tree.table(tree.read(page), heading)]


class Drivers(unittest.TestCase):
    def test_the_guide_lists_the_installed_commands(self):
        scripts = re.split(r"^\[", tree.read("pyproject.toml").split("[project.scripts]")[1], flags=re.M)[0]
        installed = {
            command: f"{module.replace('polyrecon_pipelines', 'pipelines').replace('.', '/')}.py"
            for command, module in re.findall(r"^([\w-]+) = \"([\w.]+):main\"$", scripts, flags=re.M)
        }
        self.assertEqual(len(installed), len(re.findall(r"^[\w-]+ =", scripts, flags=re.M)))
        rows = column_of_code("docs/guide/README.md", "script in a checkout")
        self.assertEqual(installed, {command: script for script, command in rows})

    def test_every_folder_of_drivers_has_a_row(self):
        folders = {path.name for path in (tree.ROOT / "pipelines").iterdir() if any(path.glob("*.py"))}
        self.assertIn("blender", folders)
        rows = column_of_code("pipelines/README.md", "folder")
        self.assertEqual(folders, {row[0].rstrip("/") for row in rows})

    def test_layers_are_named_as_by_the_program(self):
        header = tree.read("src/io/renderers/polyrecon.h")
        named = dict(re.findall(r"constexpr const char\* (\w+) = \"([^\"]*)\";", header))
        for constant in ("variance_suffix", "half_a_suffix", "half_b_suffix", "sample_count_pass"):
            self.assertEqual(getattr(layer_names, constant.upper()), named[constant])


if __name__ == "__main__":
    unittest.main()
