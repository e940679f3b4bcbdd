"""The program polyrecon, its drivers and Open Image Denoise.

Program and drivers are in a wheel that comes with the extension and that Blender installs among its modules."""

import importlib.util
import os
import pathlib
import sys

OIDN = "libOpenImageDenoise.so.2"


class SetupError(Exception):
    """A problem that the user can solve. The text is one line."""


def _packages():
    """The folder that the wheel was installed into."""
    found = importlib.util.find_spec("polyrecon_pipelines")
    if not found:
        raise SetupError("the extension is incomplete: install polyrecon.zip anew")
    return pathlib.Path(found.submodule_search_locations[0]).parent


def make_executable():
    """Gives the program the permission to execute, without which Blender unpacks wheels."""
    if not importlib.util.find_spec("polyrecon_pipelines"):
        return  # The panel says so.
    program = _packages() / "polyrecon" / "bin" / "polyrecon"
    if program.exists() and not os.access(program, os.X_OK):
        program.chmod(0o755)


def find_program(given=""):
    """The path of the program: `given`, else by the rule of the drivers: $POLYRECON, the wheel, the PATH."""
    _packages()
    from polyrecon_pipelines.common import errors, polyrecon_cli

    try:
        return polyrecon_cli.find_polyrecon(given)
    except errors.DriverError as error:
        raise SetupError(str(error)) from error


def driver_words(name, blender):
    """The command that starts a driver such as adaptive. blender: the path of the Blender that renders; empty if
    Blender is a module of this Python."""
    _packages()
    renderer = ["--blender", blender] if blender else ["--bpy"]
    return [sys.executable, "-B", "-m", f"polyrecon_pipelines.blender.{name}", *renderer]


def find_oidn(given=""):
    """The library of Open Image Denoise: `given`, else $POLYRECON_OIDN, else Blender's, else that of the package
    pyoidn. None where there is none."""
    named = given or os.environ.get("POLYRECON_OIDN")
    if named:
        path = pathlib.Path(named)
        if path.is_dir():
            path /= OIDN
        return path if path.exists() else None
    import bpy

    blender = pathlib.Path(bpy.app.binary_path or bpy.__file__).resolve().parent
    places = [blender / "lib" / OIDN]
    if found := importlib.util.find_spec("pyoidn"):
        places.append(pathlib.Path(found.submodule_search_locations[0]) / "oidn" / "lib" / OIDN)
    return next((place for place in places if place.exists()), None)


def environment(oidn=None):
    """The environment of the programs: drivers find the wheels' modules and Blender's, and the program finds Open Image
    Denoise."""
    import bpy

    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    blender = pathlib.Path(bpy.utils.resource_path("LOCAL")) / "python" / "lib" / version / "site-packages"
    found = {name: value for name, value in os.environ.items() if name != "PYTHONHOME"}
    found["PYTHONPATH"] = os.pathsep.join(os.fspath(folder) for folder in (_packages(), blender) if folder.is_dir())
    if oidn:
        found["POLYRECON_OIDN"] = os.fspath(oidn)
    return found
