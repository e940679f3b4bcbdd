"""Denoises Monte Carlo renders that are numpy arrays or EXR files.

    import polyrecon

    clean = polyrecon.denoise(beauty, albedo, normal, depth)
    clean.image                                # (height, width, 3) float32
    clean.relmse.mean()                        # estimated error, as a share of the brightness squared

    render = polyrecon.read("render.exr")      # arrays by the names of their roles
    polyrecon.write("clean.exr", polyrecon.denoise(render), like="render.exr")

All work is done by libpolyrecon, on all processors and without the interpreter's lock, so Python threads go on
meanwhile. Arrays are (height, width, channels) or (height, width), from the upper left pixel, float16 or float32 in any
memory order; float64 is converted. Colours are linear radiance. Whatever fails raises `polyrecon.Error`, whose
`exit_code` is that of the program `polyrecon`.
"""

from ._arrays import Images, Result
from ._calls import denoise, merge, read, sample_map, write
from ._library import Error, StoppedError, library_path, version

__version__ = version()

__all__ = [
    "Error",
    "Images",
    "Result",
    "StoppedError",
    "__version__",
    "denoise",
    "library_path",
    "merge",
    "read",
    "sample_map",
    "write",
]
