"""docs/reference/environment.md lists every environment variable that the program or a driver reads, and no other."""

import re
import unittest

from . import tree

READS = re.compile(r"(?:getenv\(|environ\.get\(|environ\[|environ\.pop\(|getenv\s*\()\s*\"(\w+)\"")


class Environment(unittest.TestCase):
    def test_table_holds_what_is_read(self):
        read = set()
        for path in tree.files():
            if path.parts[0] in ("src", "pipelines", "python") and path.suffix in (".cpp", ".h", ".py"):
                read |= set(READS.findall(tree.read(path)))
        self.assertIn("OCIO", read)
        rows = tree.table(tree.read("docs/reference/environment.md"), "variable")
        self.assertEqual(read, {row[0].strip("`") for row in rows})


if __name__ == "__main__":
    unittest.main()
