"""Where polyrecon's program and its drivers are, and the words that start them. Knows nothing of Blender's data."""

import os
import pathlib
import shutil
import sys

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
    places += [root / "build" / build / "src" / "polyrecon" for root in HERE.parents[2:3] for build in ("release", "dev")]
    for place in places:
        if os.access(place, os.X_OK):
            return place
    raise Problem("polyrecon is not on the PATH: name the program in the add-on's preferences")


def find_driver(name, given="", program=None):
    """A driver script like adaptive.py: in the folder of the preferences, else in the checkout that this add-on or the
    program belongs to, else where the program was installed."""
    if given:
        places = [pathlib.Path(given)]
    else:
        places = [HERE.parent]
        if program is not None:
            program = pathlib.Path(program).resolve()
            places += [root / "pipelines" / "blender" for root in program.parents[1:4]]
            places += [program.parents[1] / "share" / "polyrecon" / "pipelines" / "blender"]
    for place in places:
        if (place / name).is_file():
            return place / name
    raise Problem(f"{name} was not found: name the folder pipelines/blender in the add-on's preferences")


def driver_words(driver, blender, python=""):
    """The words that start a driver which renders by the Blender of that path; none: Blender is a module of this Python.

    The driver runs in the Python of the preferences, or the system's: Blender's own lacks the packages it needs."""
    if not blender:
        return [python or sys.executable, os.fspath(driver), "--bpy"]
    python = python or shutil.which("python3") or shutil.which("python")
    if not python:
        raise Problem("no python3 on the PATH: name one in the add-on's preferences")
    return [python, os.fspath(driver), "--blender", blender]


def environment():
    """This process's own, without what would lead another Python to Blender's packages."""
    return {name: value for name, value in os.environ.items() if name not in ("PYTHONHOME", "PYTHONPATH")}
