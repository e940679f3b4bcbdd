"""Frame ranges ("1-10,20-40x2") and the names of a sequence's files ("shot.####.exr"), with the rules of the program.

Frame names follow the tools that write the files:

- `####` stands for at least so many digits with a minus sign before them: frame -5 is -0005, as Blender writes it.
- `%04d` is C's format, where the sign counts as a digit: frame -5 is -005, as Nuke and OpenImageIO write it.
- The last place of this kind in the file's name is the frame's number, as in Blender. Other places, in the name or
  in its folders, stand for the number only where they have the very same text, as in Nuke: "####/shot.####.exr".
  Folders that exist under exactly this name have no places.

tests/inputs/frame_names.json has examples of every rule; the tests of the program and of the drivers read it.
"""

import os
import pathlib
import re

from .errors import DriverError, ExitCode

MAX_FRAMES = 1_000_000
_INT_MIN, _INT_MAX = -(2**31), 2**31 - 1
# A step is written x2 by the program and most renderers, and :2 by Open Job Description.
_RANGE = re.compile(r"(-?[0-9]+)(?:-(-?[0-9]+)(?:[x:]([0-9]+))?)?")
_PLACE = re.compile(r"#+|%(?:0([1-9]))?d")


def parse_ranges(text):
    """The frames of "1-4,10-20x5", [1, 2, 3, 4, 10, 15, 20]: in the order given, each once."""
    frames = {}
    for piece in text.split(","):
        frames.update(dict.fromkeys(_parse_range(text, piece.strip(" "))))
        if len(frames) > MAX_FRAMES:
            raise _bad_ranges(text, f"there are more than {MAX_FRAMES} frames")
    return list(frames)


def _parse_range(text, piece):
    match = _RANGE.fullmatch(piece)
    if not match:
        raise _bad_ranges(text, f"'{piece}' is neither a frame nor a range")
    first, last, step = (None if word is None else _number(text, word) for word in match.groups())
    last, step = first if last is None else last, 1 if step is None else step
    if step < 1:
        raise _bad_ranges(text, f"the step of '{piece}' is 0")
    if last < first:
        raise _bad_ranges(text, f"'{piece}' runs backwards")
    if (last - first) // step >= MAX_FRAMES:
        raise _bad_ranges(text, f"'{piece}' has more than {MAX_FRAMES} frames")
    return range(first, last + 1, step)


def _number(text, word):
    digits = word.lstrip("-0") or "0"  # Python refuses to convert thousands of digits.
    number = int(digits[:20]) * (-1 if word.startswith("-") else 1)
    if not _INT_MIN <= number <= _INT_MAX:
        raise _bad_ranges(text, f"{word} is too large")
    return number


def _bad_ranges(text, reason):
    return DriverError(ExitCode.USAGE, f"--frames {text}: {reason}; write it as 1-10,20-40x2,50")


def ranges_text(frames):
    """The shortest text that parse_ranges turns into these frames, without steps: [1, 2, 3, 9] -> "1-3,9"."""
    runs = []
    for frame in frames:
        if runs and frame == runs[-1][-1] + 1:
            runs[-1].append(frame)
        else:
            runs.append([frame])
    return ",".join(f"{run[0]}-{run[-1]}" if len(run) > 2 else ",".join(map(str, run)) for run in runs)


def is_pattern(path):
    """Whether the file's name has a place for the frame's number."""
    return _PLACE.search(_split(path)[1]) is not None


def frame_path(pattern, frame):
    """The path of one frame's file. The pattern is a text or a path; the result is a text."""
    folder, name = _split(pattern)
    place = [match.group() for match in _PLACE.finditer(name)][-1]
    number = _format(place, frame)

    def filled(text):
        return _PLACE.sub(lambda match: number if match.group() == place else match.group(), text)

    return (folder if os.path.isdir(folder) else filled(folder)) + filled(name)


def without_number(pattern, name):
    """The path of a file for all frames of a pattern: shot.####.html -> shot.html. `name` is its name where nothing but
    the number was in it. Folders that have the number too are left out: ####/shot.####.html -> shot.html."""
    folder, text = _split(pattern)
    place = list(_PLACE.finditer(text))[-1]
    stem, suffix = text[: place.start()].rstrip("._- "), text[place.end() :]
    if not os.path.isdir(folder):
        numbered = [match.start() for match in _PLACE.finditer(folder) if match.group() == place.group()]
        folder = folder[: folder.rfind("/", 0, numbered[0]) + 1] if numbered else folder
    return folder + (stem + suffix if stem else name + suffix)


def passes_of_all(pattern):
    """The folder of the passes of all frames of a pattern: out/shot_####.exr -> out/shot.passes."""
    return pathlib.Path(without_number(pattern, "shot")).with_suffix(".passes")


def passes_of_frame(folder, frame):
    """The folder of the passes of one of several frames, in that of all."""
    return folder / frame_path("####", frame)


def _split(path):
    """The folder with the slash that ends it, and the file's name."""
    folder, slash, name = str(path).rpartition("/")
    return folder + slash, name


def _format(place, frame):
    if place.startswith("#"):
        return f"{'-' if frame < 0 else ''}{abs(frame):0{len(place)}d}"
    return place % frame
