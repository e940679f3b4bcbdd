"""Open Image Denoise as a second opinion: whether the program can use it, before hours of rendering need it."""

import numpy as np

from ..common import exr
from ..common.errors import DriverError
from ..common.work_folder import WorkFolder
from .reconstruction import PRIOR

SIZE = 16  # Pixels per side of the picture that is tried


def check(polyrecon):
    """Raises DriverError where `polyrecon denoise --prior oidn` does not work."""
    with WorkFolder("prior") as folder:
        ramp = np.linspace(0.1, 0.9, SIZE * SIZE).reshape(SIZE, SIZE)
        exr.write(folder / "trial.exr", dict.fromkeys("RGB", ramp))
        words = ["-i", folder / "trial.exr", "-o", folder / "clean.exr", "--quality", "draft", *PRIOR, "--quiet"]
        try:
            polyrecon.run("denoise", *words)
        except DriverError as error:
            raise DriverError(
                error.code, f"--with-prior: {error} ($POLYRECON_OIDN, as a driver has no --oidn)"
            ) from error


def advice(polyrecon):
    """How to get a second opinion on this machine."""
    try:
        check(polyrecon)
    except DriverError:
        return "--with-prior (after pip install pyoidn)"
    return "--with-prior"
