"""The files that a POV-Ray scene uses, as far as its text names them."""

import os
import pathlib
import re

from ..common.files import open_regular

LARGEST_TEXT = 1 << 26  # Bytes of a file in which names are looked for
_STRING = re.compile(rb'"([^"\n\0]+)"')
_LIBRARY = re.compile(r"(?im)^\s*(?:[+-]L|Library_Path\s*=)\s*\"?(.+?)\"?\s*$")
_CONFIGURATIONS = ("/etc/povray/3.7/povray.ini", "~/.povray/3.7/povray.ini")


def used(scene, options):
    """{path: [path]} of the scene, its .ini files, and all files whose names stand in one of them as a string.

    A name that the scene composes while it is parsed is not found."""
    scene = pathlib.Path(scene).absolute()
    configurations = [*map(os.path.expanduser, _CONFIGURATIONS), os.environ.get("POVINI", "")]
    named = [scene, scene.parent / "povray.ini", *configurations, *(re.sub(r"\[.*\]$", "", word) for word in options)]
    waiting = [path for path in map(os.path.realpath, filter(None, named)) if os.path.isfile(path)]
    texts = [*options, *(_text(path).decode("utf-8", "surrogateescape") for path in waiting)]
    folders = [scene.parent, pathlib.Path.cwd(), *(match for text in texts for match in _LIBRARY.findall(text))]
    found = {}
    while waiting:
        path = waiting.pop()
        if path not in found:
            found[path] = [path]
            waiting += [file for name in _STRING.findall(_text(path)) for file in _located(name, folders)]
    return found


def _text(path):
    """The content of a file; nothing of a file that is no text."""
    try:
        with open_regular(path) as file:
            content = file.read(min(LARGEST_TEXT, os.fstat(file.fileno()).st_size))
    except OSError:
        return b""
    return b"" if b"\0" in content else content


def _located(name, folders):
    paths = (os.path.realpath(os.path.join(folder, os.fsdecode(name))) for folder in folders)
    return [path for path in paths if os.path.isfile(path)]
