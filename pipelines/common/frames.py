"""Frame ranges and numbered file names, as Blender's and Nuke's command lines know them."""

import pathlib
import re

from .errors import DriverError, ExitCode

PIECE = re.compile(r"(-?\d+)(?:-(-?\d+)(?:x([1-9]\d*))?)?$")
HASHES, PERCENT = re.compile(r"#+"), re.compile(r"%0?(\d*)d")


def parse_frames(text):
    """'1-3,10-20x5' -> [1, 2, 3, 10, 15, 20], each frame once."""
    frames = []
    for piece in text.split(","):
        match = PIECE.match(piece.strip())
        first, last, step = (int(group) if group else None for group in match.groups()) if match else (0, -1, 1)
        numbers = range(first, (first if last is None else last) + 1, step or 1)
        if not numbers:
            raise DriverError(ExitCode.USAGE, f"--frames {text}: not a range of frames like 1-10,20-40x2")
        frames += [number for number in numbers if number not in frames]
    return frames


def frame_path(pattern, frame, several=False):
    """The file of one frame: the last #### or %04d in the name is the frame's number. Several frames need one; without a
    frame (None: the scene's own) the name is taken as it is."""
    folder, name = pathlib.Path(pattern).parent, pathlib.Path(pattern).name
    places = [(m, len(m[0])) for m in HASHES.finditer(name)] or [(m, int(m[1] or 1)) for m in PERCENT.finditer(name)]
    if frame is None or not (places or several):
        return folder / name
    if not places:
        raise DriverError(ExitCode.USAGE, f"{pattern}: needs #### or %04d for the frame's number")
    place, digits = places[-1]
    return folder / f"{name[: place.start()]}{frame:0{digits}d}{name[place.end() :]}"
