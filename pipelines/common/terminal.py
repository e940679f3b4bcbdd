"""Lines for a terminal or a log. What came from a file or a child process cannot begin a line of its own there, move
the cursor, or change colours and titles."""

import re
import sys

# Control characters (C0, DEL, C1), line and paragraph separators, marks that reorder text, and the surrogates that
# stand for bytes of a path that is not UTF-8.
_UNPRINTABLE = re.compile("[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
_NAMES = {"\n": "\\n", "\r": "\\r", "\t": "\\t"}


def printable(text):
    """The text on one line: characters that a terminal would act on are written as escapes, such as \\x1b."""
    return _UNPRINTABLE.sub(_escape, str(text))


def print_lines(*lines, file=None):
    """Prints each text as one line, in the encoding of the file (default: standard output)."""
    file = file or sys.stdout
    encoding = getattr(file, "encoding", None) or "utf-8"
    for line in lines:
        print(printable(line).encode(encoding, "backslashreplace").decode(encoding), file=file, flush=True)


def size_text(size):
    """A number of bytes, to read."""
    for unit, name in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if size >= unit:
            return f"{size / unit:.1f} {name}"
    return f"{size:.0f} bytes"


def quiet_or_print(options):
    """The function that prints lines of a driver: print_lines, or one that does nothing with --quiet."""
    return (lambda *lines: None) if options.quiet else print_lines


def _escape(match):
    character = match.group()
    if character in _NAMES:
        return _NAMES[character]
    code = ord(character)
    if 0xDC80 <= code <= 0xDCFF:  # os.fsdecode's code for the byte code - 0xDC00
        code -= 0xDC00
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
