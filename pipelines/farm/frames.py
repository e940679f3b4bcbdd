"""Frame numbers and the names of a sequence's files, as `polyrecon denoise --frames` takes them."""

import re

from ..common.errors import DriverError, ExitCode

# 1-10, 20-40x2 as the program and most renderers write steps; 20-40:2 as Open Job Description does.
_RANGE = re.compile(r"(-?\d+)(?:-(-?\d+)(?:[x:](\d+))?)?")
_PLACE = re.compile(r"#+|%(?:0(\d))?d")


def parse(text):
    """ "1-4,10-20x5" -> [1, 2, 3, 4, 10, 15, 20]: in the order given, each once."""
    frames = {}
    for piece in text.split(","):
        match = _RANGE.fullmatch(piece.strip())
        if not match:
            raise DriverError(ExitCode.USAGE, f"--frames {text}: '{piece}' is no frame or range, write 1-10,20-40x2,50")
        first, last, step = (int(word) if word else None for word in match.groups())
        last, step = first if last is None else last, 1 if step is None else step
        if step < 1 or last < first:
            raise DriverError(ExitCode.USAGE, f"--frames {text}: '{piece}' runs backwards or not at all")
        frames.update(dict.fromkeys(range(first, last + 1, step)))
    return list(frames)


def text(frames):
    """The shortest text of ranges without steps: [1, 2, 3, 9] -> "1-3,9"."""
    runs = []
    for frame in frames:
        if runs and frame == runs[-1][1] + 1:
            runs[-1][1] = frame
        else:
            runs.append([frame, frame])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in runs)


def chunks(frames, size):
    """The frames in groups of `size`, in order."""
    return [frames[k : k + size] for k in range(0, len(frames), size)]


def is_pattern(name):
    return _PLACE.search(str(name)) is not None


def path(pattern, frame):
    """The name with the frame's number in place of every #### or %04d; a sign stands before the padded number."""

    def number(match):
        place = match.group()
        digits = len(place) if place.startswith("#") else int(match.group(1) or 1)
        return f"{'-' if frame < 0 else ''}{abs(frame):0{digits}d}"

    return _PLACE.sub(number, str(pattern))
