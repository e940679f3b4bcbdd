"""The files that a user requested: their endings, what may not be overwritten, and the picture that is delivered."""

import os
import pathlib
import shlex
import shutil

import numpy as np

from . import exr
from .denoise_defaults import DEFAULT_OUTPUTS
from .errors import DriverError, ExitCode
from .files import replacing

HINTS = {".exr": "`polyrecon preview` makes pictures to look at", ".html": "the report is a page"}
# The compressions of OpenEXR, in OpenImageIO's words.
COMPRESSIONS = ("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab")
DEFAULT_DWA_LEVEL = 45.0  # OpenEXR's
WITH_LEVEL = ("dwaa", "dwab")
LOSSY = ("b44", *WITH_LEVEL)  # beginnings of the names of compressions that change half floats
LAYOUT_ATTRIBUTES = ("name", "oiio:subimage", "openexr:")  # They say how the file is divided and encoded.
HALF_LIMIT = 65504.0  # The largest half float


def check_ending(path, ending):
    """Refuses a name whose ending stands for another format."""
    if pathlib.Path(path).suffix.lower() != ending:
        raise DriverError(ExitCode.USAGE, f"{path}: the name must end in {ending}; {HINTS[ending]}")


def check_new(paths, overwrite):
    """Refuses files that exist already, before any work. `overwrite`: whether the user allows to replace them."""
    found = [] if overwrite else [path for path in paths if os.path.lexists(path)]
    if found:
        more = f", and {len(found) - 1} more outputs exist already" if len(found) > 1 else ""
        raise DriverError(ExitCode.USAGE, f"{found[0]}: exists already{more}; add --overwrite to replace it")


def check_writable(paths):
    """Refuses files that could not be written, before any work: their folders, as far as they exist, are looked at."""
    for folder in {nearest_folder(path) for path in paths}:
        if not folder.is_dir():
            raise DriverError(ExitCode.OUTPUT, f"{folder}: is not a folder")
        if not os.access(folder, os.W_OK | os.X_OK):
            raise DriverError(ExitCode.OUTPUT, f"{folder}: no permission to write into this folder")


def nearest_folder(path):
    """The folder of a file, or where that is missing the nearest one above it that exists."""
    folder = pathlib.Path(path).absolute().parent
    while not os.path.lexists(folder):
        folder = folder.parent
    return folder


def add_contents(parser):
    """Adds the options that say what the picture's file holds, and how it is compressed. The program checks the words
    of --outputs."""
    parser.add_argument(
        "--outputs",
        default=DEFAULT_OUTPUTS,
        metavar="LIST",
        help="what the result holds, as of `polyrecon denoise`: beauty, layers or input, and in addition noisy, error "
        "and order; input is what the scene requests, with --keep-passes all that was rendered",
    )
    parser.add_argument(
        "--compression",
        choices=COMPRESSIONS,
        metavar="NAME",
        help=f"of the result: {', '.join(COMPRESSIONS)} (default: as the scene says, else zip)",
    )
    parser.add_argument(
        "--dwa-level",
        type=float,
        default=DEFAULT_DWA_LEVEL,
        metavar="L",
        help="loss of --compression dwaa and dwab: higher makes smaller files",
    )


def deliver(source, target, type_of, compression, attributes=None):
    """Writes channels of an EXR file to `target`, in one part.

    type_of(name): "half", "float", or None for a channel that is left out. attributes: more than the source has.
    Returns a note; '' if all is as requested."""
    names = exr.names(source)
    changed = [name for name in names if type_of(name) == "float" and changes_floats(compression, name)]
    note = f"{target}: zip, as {compression.partition(':')[0]} would change {changed[0]}" if changed else ""
    compression = "zip" if changed else compression
    types, channels = {}, {}
    limit = HALF_LIMIT / 2 if compression.startswith(LOSSY) else HALF_LIMIT  # Their errors must not lead beyond it.
    for name, values in exr.read(source).items():
        if kind := type_of(name):
            types[name] = kind
            channels[name] = np.clip(values, -limit, limit) if kind == "half" else values
    kept = {name: value for name, value in exr.metadata(source).items() if not name.startswith(LAYOUT_ATTRIBUTES)}
    halves = {name for name, kind in types.items() if kind == "half"}
    exr.write(target, channels, {**kept, **(attributes or {})}, compression, halves)
    return note


def changes_floats(compression, name):
    """Whether the compression changes 32-bit floats of a channel, such as ids in channels that are named as colours."""
    lossy_colour = compression.startswith(WITH_LEVEL) and name.rpartition(".")[2] in ("R", "G", "B", "Y", "RY", "BY")
    return lossy_colour or compression == "pxr24"


def copy(source, target):
    """Copies a file. The copy appears complete or not at all."""
    with replacing(target) as temporary:
        shutil.copyfile(source, temporary)


def encoding(compression, dwa_level):
    """The compression in OpenImageIO's words, which include the level."""
    return f"{compression}:{dwa_level:g}" if compression in WITH_LEVEL else compression


def is_colour(name):
    """Whether a channel holds a colour or alpha. Cryptomatte has ids in channels of these names."""
    *layers, channel = name.split(".")
    return channel in ("R", "G", "B", "A") and not (layers and layers[-1].startswith("Crypto"))


def removal(folders):
    """The command line that removes these folders."""
    names = [str(folder) for folder in folders]
    return shlex.join(["rm", "-r", *(["--"] if any(name.startswith("-") for name in names) else []), *names])
