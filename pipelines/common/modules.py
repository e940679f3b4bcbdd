"""Whether this Python has the modules that a driver imports. It imports nothing that may be missing."""

import contextlib
import importlib.util
import os
import sys

from .errors import ExitCode
from .terminal import print_lines

# Names of the modules: for pip, for Debian.
_PACKAGES = {
    "jinja2": ("jinja2", "python3-jinja2"),
    "numpy": ("numpy", "python3-numpy"),
    "OpenImageIO": ("OpenImageIO", "python3-openimageio"),
    "rich": ("rich", "python3-rich"),
    "yaml": ("PyYAML", "python3-yaml"),
}
RENDERING = ("numpy", "OpenImageIO", "jinja2", "rich")


@contextlib.contextmanager
def required(program, names):
    """A context for a driver's imports. Where one of the modules is missing, the program ends with one line and exit
    code 4."""
    missing = [name for name in names if importlib.util.find_spec(name) is None]
    if missing:
        print_lines(f"{program}: {advice(missing)}", file=sys.stderr)
        sys.exit(ExitCode.MISSING)
    yield


def advice(missing):
    """Advice about missing modules, on one line."""
    pip, debian = (" ".join(names) for names in zip(*(_PACKAGES[name] for name in missing)))
    plural = "s" if len(missing) > 1 else ""
    commands = f"{os.path.abspath(sys.executable)} -m pip install {pip} (Debian: apt-get install {debian})"
    return f"this Python lacks the module{plural} {', '.join(missing)}: {commands}"
