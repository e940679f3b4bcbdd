import io
import unittest

from pipelines.common.terminal import print_lines, printable, size_text

FORGED = {
    "a\nopenjd_fail: b": "a\\nopenjd_fail: b",
    "a\r\nb\tc": "a\\r\\nb\\tc",
    "\x1b]0;title\x07\x1b[31mred": "\\x1b]0;title\\x07\\x1b[31mred",
    "\x9b2J\x7f\x00": "\\x9b2J\\x7f\\x00",  # C1, DEL, NUL
    "a\x0bb\x0cc\x1cd\x85e\u2028f\u2029g": "a\\x0bb\\x0cc\\x1cd\\x85e\\u2028f\\u2029g",  # str.splitlines
    "txt\u202eexe\u2066": "txt\\u202eexe\\u2066",
    "\udce9.exr": "\\xe9.exr",  # a path that is not UTF-8
    "\ud800": "\\ud800",
    "ä日 \\ 'x' 😀": "ä日 \\ 'x' 😀",  # as it is
}


class Terminal(unittest.TestCase):
    def test_terminal_escapes(self):
        for text, shown in FORGED.items():
            self.assertEqual(printable(text), shown)
            self.assertEqual(len(printable(text).splitlines()), 1)

    def test_every_character_leaves_one_line_that_can_be_encoded(self):
        for code in range(0x110000):
            shown = printable(chr(code))
            self.assertTrue(len(shown.splitlines()) == 1 and shown.encode(), hex(code))
            self.assertTrue(code >= 0x20 or "\\" in shown, hex(code))

    def test_each_text_is_a_line_in_any_encoding(self):
        for encoding, shown in (("utf-8", "日\\n\nä\n"), ("ascii", "\\u65e5\\n\n\\xe4\n")):
            with io.BytesIO() as content, io.TextIOWrapper(content, encoding, newline="\n") as file:
                print_lines("日\n", "ä", file=file)
                self.assertEqual(content.getvalue().decode(encoding), shown)

    def test_sizes_have_a_unit_that_fits(self):
        for size, text in ((0, "0 bytes"), (999, "999 bytes"), (21_540, "21.5 kB"), (3e6, "3.0 MB"), (41e9, "41.0 GB")):
            self.assertEqual(size_text(size), text)


if __name__ == "__main__":
    unittest.main()
