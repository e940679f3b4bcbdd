"""What is written in two places about passes: the guide's table of switches, and the passes that Blender's driver asks
for, agree with the names that the program knows (src/io/renderers/)."""

import re
import unittest

from pipelines.blender.renderer import PART_LAYERS

from . import tree

PAGE = "docs/guide/passes.md"
RENDERERS = {
    "blender": "Blender 4.2 to 5.2",
    "mitsuba": "Mitsuba 3",
    "luxcore": "LuxCore",
    "arnold": "Arnold",
    "vray": "V-Ray",
}
# Words of a table that the short advice of the program leaves out, or the other way round.
EXTRA = r"[`\",]|\(Output Denoising AOVs\)|\bthe\b|\bof\b|\baov\b|\bintegrator\b"


def words(text):
    return sorted(re.sub(EXTRA, " ", text).split())


class Passes(unittest.TestCase):
    def test_the_guide_names_the_switches_that_the_program_names(self):
        heading = next(line for line in tree.read(PAGE).splitlines() if line.startswith("| pass | without it"))
        columns = [cell.strip() for cell in heading.strip("|").split("|")]
        rows = {row[0]: row for row in tree.table(tree.read(PAGE), "pass")}
        for renderer, column in RENDERERS.items():
            source = tree.read(f"src/io/renderers/{renderer}.cpp")
            switches = re.findall(r"\{Role::(\w+), \"((?:[^\"\\]|\\.)*)\"\},", source.split("r.switches = {")[1])
            self.assertEqual([role for role, _ in switches], ["Albedo", "Normal", "Depth"], renderer)
            cell = ""
            for role, place in switches:
                found = rows[role.lower()][columns.index(column)]
                cell = cell if found == "the same" else found
                self.assertEqual(words(cell), words(place.replace("\\", "")), (renderer, role))

    def test_the_driver_asks_for_passes_that_the_program_knows(self):
        known = set(re.findall(r"\{\"([^\"]+)\", Role::\w+, \d\}", tree.read("src/io/renderers/blender.cpp")))
        self.assertGreater(len(known), 5)
        self.assertEqual(PART_LAYERS - known, set())


if __name__ == "__main__":
    unittest.main()
