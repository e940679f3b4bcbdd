"""Whether this Python has the modules that a driver imports. It imports nothing that may be missing."""

import contextlib
import importlib
import importlib.util
import os
import sys

from .errors import ExitCode
from .terminal import print_lines

_PIP = {"yaml": "PyYAML"}  # where pip's name is another than the module's
_DEBIAN = {
    "jinja2": "python3-jinja2",
    "numpy": "python3-numpy",
    "OpenImageIO": "python3-openimageio",
    "rich": "python3-rich",
    "yaml": "python3-yaml",
}
_FOR_PYTHONS = {"bpy": "3.11 or 3.13"}  # where pip has a module for these alone
RENDERING = ("numpy", "OpenImageIO", "jinja2", "rich")
OLDEST_PYTHON = (3, 9)


@contextlib.contextmanager
def required(program, names):
    """A context for a driver's imports. Where this Python is too old, or one of the modules is missing or broken, the
    program ends with one line and exit code 4."""
    try:
        if problem := too_old(sys.version_info) or advice([name for name in names if not is_there(name)]):
            _end(program, problem)
        yield
    except ImportError:
        if problem := next(filter(None, map(_why_broken, names)), None):
            _end(program, problem)
        raise


def is_there(name):
    return importlib.util.find_spec(name) is not None


def advice(missing):
    """Advice about missing modules, on one line; empty without any."""
    if not missing:
        return ""
    debian = " ".join(_DEBIAN[name] for name in missing if name in _DEBIAN)
    notes = [f"for Python {_FOR_PYTHONS[name]}" for name in missing if name in _FOR_PYTHONS]
    notes += [f"Debian: apt-get install {debian}"] if debian else []
    text = f"this Python lacks the module{'s' if len(missing) > 1 else ''} {', '.join(missing)}: {_pip(missing)}"
    return f"{text} ({'; '.join(notes)})" if notes else text


def _pip(names, *options):
    packages = [_PIP.get(name, name) for name in names]
    return " ".join([os.path.abspath(sys.executable), "-m", "pip", "install", *options, *packages])


def too_old(version):
    """Why a Python of this version cannot run the drivers; empty if it can."""
    if version >= OLDEST_PYTHON:
        return ""
    return "Python {}.{} or later is needed; {} is {}.{}".format(*OLDEST_PYTHON, sys.executable, *version)


def _why_broken(name):
    """Why a module that is there cannot be imported, for example because it was compiled for another numpy."""
    try:
        importlib.import_module(name)
    except ImportError as error:
        reason = next(filter(None, map(str.strip, str(error).splitlines())), "")
        return f"the module {name} of this Python cannot be imported ({reason}): {_pip([name], '--force-reinstall')}"
    return ""


def _end(program, problem):
    print_lines(f"{program}: {problem}", file=sys.stderr)
    sys.exit(ExitCode.MISSING)
