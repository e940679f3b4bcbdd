"""Where the tests find Open Image Denoise: $POLYRECON_OIDN, or the package pyoidn of this Python."""

import importlib.util
import os
from pathlib import Path


def library():
    """The path of the library; '' without one."""
    if named := os.environ.get("POLYRECON_OIDN"):
        return named
    package = importlib.util.find_spec("pyoidn")
    found = Path(package.origin).parent / "oidn" / "lib" / "libOpenImageDenoise.so.2" if package else None
    return str(found) if found and found.exists() else ""


OIDN = library()
NO_OIDN = "no Open Image Denoise: tests/pipelines/make_venv.sh installs pyoidn"
