"""Finds the program polyrecon and its drivers. Uses nothing of Blender."""

import os
import pathlib
import shutil
import sys

COMMANDS = {"adaptive.py": "polyrecon-blender"}  # names of the installed drivers
HERE = pathlib.Path(__file__).resolve().parent


class SetupError(Exception):
    """A problem that the user can solve. The text is one line."""


def find_program(given=""):
    """The path of the program: `given`, else $POLYRECON, each a path or a name on the PATH; else polyrecon on the PATH,
    else the build of this checkout. The drivers' rule is the same (pipelines/common/polyrecon_cli.py), of which an
    installed extension has no copy; tests/pipelines/common/test_program.py compares them."""
    for named, source in ((given, "the add-on's preferences"), (os.environ.get("POLYRECON"), "$POLYRECON")):
        if named:
            if not (found := shutil.which(named)):
                raise SetupError(f"{named}: no such program ({source})")
            return pathlib.Path(found).absolute()
    if found := shutil.which("polyrecon"):
        return pathlib.Path(found)
    for root in HERE.parents[2:3]:
        for build in ("release", "dev"):
            if os.access(program := root / "build" / build / "src" / "polyrecon", os.X_OK):
                return program
    raise SetupError("polyrecon is not on the PATH: choose the program in the add-on's preferences")


def driver_words(name, program, blender, folder="", python=""):
    """The command that starts a driver such as adaptive.py.

    blender: the path of the Blender that renders; empty if Blender is a module of this Python. The driver is searched
    in the folder of the preferences, or else in the checkout of this add-on, in that of the program, next to the
    program as an installed command, and on the PATH."""
    places = (
        [folder]
        if folder
        else [HERE.parent, *(root / "pipelines" / "blender" for root in program.resolve().parents[3:4])]
    )
    found = next((script for place in places if (script := pathlib.Path(place) / name).is_file()), None)
    if found:
        return [python or _python(blender), os.fspath(found), *_blender_words(blender)]
    command = COMMANDS.get(name, name)
    installed = None if folder else shutil.which(command, path=program.parent) or shutil.which(command)
    if not installed:
        raise SetupError(f"{name} was not found: choose the folder pipelines/blender in the add-on's preferences")
    return [installed, *_blender_words(blender)]


def _blender_words(blender):
    return ["--blender", blender] if blender else ["--bpy"]


def _python(blender):
    """The Python of the drivers. Blender's Python has their packages only if Blender is a module of it."""
    python = (shutil.which("python3") or shutil.which("python")) if blender else sys.executable
    if not python:
        raise SetupError("no python3 on the PATH: choose one in the add-on's preferences")
    return python


def environment():
    """The environment of this process without the variables that lead another Python to Blender's packages."""
    return {name: value for name, value in os.environ.items() if name not in ("PYTHONHOME", "PYTHONPATH")}
