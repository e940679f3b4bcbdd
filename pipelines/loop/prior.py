"""Open Image Denoise as a second opinion: whether the program can use it, before hours of rendering need it."""

import numpy as np

from ..common import exr
from ..common.errors import DriverError
from ..common.polyrecon_cli import Polyrecon
from ..common.work_folder import WorkFolder
from .reconstruction import PRIOR

SIZE = 16  # Pixels per side of the picture that is tried


def check(program):
    """Raises DriverError where `polyrecon denoise --prior oidn` does not work. program: the value of --polyrecon."""
    with WorkFolder("prior") as folder:
        ramp = np.linspace(0.1, 0.9, SIZE * SIZE).reshape(SIZE, SIZE)
        exr.write(folder / "trial.exr", dict.fromkeys("RGB", ramp))
        words = ["-i", folder / "trial.exr", "-o", folder / "clean.exr", "--quality", "draft", *PRIOR, "--quiet"]
        try:
            Polyrecon(program).run("denoise", *words)
        except DriverError as error:
            raise DriverError(
                error.code, f"--with-prior: {error} ($POLYRECON_OIDN, as a driver has no --oidn)"
            ) from error
