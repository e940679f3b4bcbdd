"""Where polyrecon's program and its drivers are, and the words that start them. Knows nothing of Blender's data."""

import os
import pathlib
import shutil
import sys

COMMANDS = {"adaptive.py": "polyrecon-blender"}  # their names once installed
HERE = pathlib.Path(__file__).resolve().parent


class Problem(Exception):
    """Something that the user can mend, in one line."""


def find_program(given=""):
    """The path of the preferences, else $POLYRECON, else polyrecon on the PATH, else the build of the checkout."""
    for named, source in ((given, "the add-on's preferences"), (os.environ.get("POLYRECON"), "$POLYRECON")):
        if named:
            if not os.access(named, os.X_OK) or os.path.isdir(named):
                raise Problem(f"{named}: no such program ({source})")
            return pathlib.Path(named)
    places = [pathlib.Path(found) for found in (shutil.which("polyrecon"),) if found]
    places += [
        root / "build" / build / "src" / "polyrecon" for root in HERE.parents[2:3] for build in ("release", "dev")
    ]
    for place in places:
        if os.access(place, os.X_OK):
            return place
    raise Problem("polyrecon is not on the PATH: name the program in the add-on's preferences")


def driver_words(name, program, blender, folder="", python=""):
    """The words that start a driver like adaptive.py, which renders by the Blender of that path; none: Blender is a module
    of this Python.

    The driver is taken from the folder of the preferences, else from the checkout that this add-on or the program belongs
    to, else it is the command that was installed beside the program or stands on the PATH."""
    places = (
        [folder]
        if folder
        else [HERE.parent, *(root / "pipelines" / "blender" for root in program.resolve().parents[3:4])]
    )
    found = next((script for place in places if (script := pathlib.Path(place) / name).is_file()), None)
    if found:
        return [python or _python(blender), os.fspath(found), *_by(blender)]
    command = COMMANDS.get(name, name)
    installed = None if folder else shutil.which(command, path=program.parent) or shutil.which(command)
    if not installed:
        raise Problem(f"{name} was not found: name the folder pipelines/blender in the add-on's preferences")
    return [installed, *_by(blender)]


def _by(blender):
    return ["--blender", blender] if blender else ["--bpy"]


def _python(blender):
    """Blender's own Python lacks the packages that a driver needs, unless Blender is a module of it."""
    python = (shutil.which("python3") or shutil.which("python")) if blender else sys.executable
    if not python:
        raise Problem("no python3 on the PATH: name one in the add-on's preferences")
    return python


def environment():
    """This process's own, without what would lead another Python to Blender's packages."""
    return {name: value for name, value in os.environ.items() if name not in ("PYTHONHOME", "PYTHONPATH")}
