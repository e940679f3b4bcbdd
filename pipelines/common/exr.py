"""Reads and writes EXR files as numpy arrays, with OpenImageIO."""

import contextlib
import os

import numpy as np
import OpenImageIO as oiio

from .errors import DriverError, ExitCode
from .files import open_regular, replacing

MAGIC = b"\x76\x2f\x31\x01"


def read(path, wanted=None):
    """The channels of all parts of a file: {full name: float32 array (height, width)}, in file order.

    If `wanted` is given, only the channels with wanted(name) are read. Of parts that have a name in common, the first
    one counts."""
    channels, part = {}, 0
    with opened(path) as file:
        while file.seek_subimage(part, 0):
            spec = file.spec()
            names = [name for name in spec.channelnames if name not in channels and (not wanted or wanted(name))]
            if names:
                pixels = file.read_image(part, 0, 0, spec.nchannels, "float")
                if pixels is None:
                    raise DriverError(ExitCode.BAD_INPUT, f"{path}: part {part}: {_error_of(file)}")
                pixels = np.asarray(pixels, np.float32).reshape(spec.height, spec.width, spec.nchannels)
                for name in names:
                    channels[name] = pixels[..., spec.channelnames.index(name)]
            part += 1
    return channels


def names(path):
    """The names of the channels of all parts, in file order."""
    found, part = [], 0
    with opened(path) as file:
        while file.seek_subimage(part, 0):
            found += file.spec().channelnames
            part += 1
    return found


def metadata(path, prefix=""):
    """The attributes of the first part whose names begin so, and that are texts or numbers: {name: value}."""
    with opened(path) as file:
        found = [attribute for attribute in file.spec().extra_attribs if attribute.name.startswith(prefix)]
        attributes = {attribute.name: attribute.value for attribute in found}
    return {name: value for name, value in attributes.items() if isinstance(value, (str, int, float))}


@contextlib.contextmanager
def opened(path):
    """A context with the oiio.ImageInput of an EXR file. OpenImageIO would open a file with this name that another of
    its formats recognises, too, so the file's first bytes are checked here."""
    try:
        with open_regular(path) as file:
            magic = file.read(len(MAGIC))
    except FileNotFoundError as error:
        raise DriverError(ExitCode.MISSING, f"{path}: {error.strerror}") from error
    except OSError as error:
        raise DriverError(ExitCode.BAD_INPUT, f"{path}: {error.strerror}") from error
    if magic != MAGIC:
        raise DriverError(ExitCode.BAD_INPUT, f"{path}: is not an EXR file")
    file = oiio.ImageInput.open(_name_for_oiio(path))
    if not file:
        raise DriverError(ExitCode.BAD_INPUT, f"{path}: {_error_of(oiio)}")
    try:
        yield file
    except UnicodeDecodeError as error:
        raise DriverError(ExitCode.BAD_INPUT, f"{path}: a name in it is not UTF-8") from error
    finally:
        file.close()


def _name_for_oiio(path):
    """The path as text, which alone newer versions of OpenImageIO's module take; as bytes if it is not UTF-8."""
    name = os.fspath(path)
    try:
        name.encode()
    except UnicodeEncodeError:
        return os.fsencode(name)
    return name


def _error_of(source):
    """The last error of OpenImageIO or of one of its files."""
    try:
        return source.geterror() or "cannot be read"
    except UnicodeDecodeError:  # It names a path that is not UTF-8.
        return "cannot be read or written"


def write(path, channels, attributes=None, compression="zip:2", halves=()):
    """Writes one part from {name: array (height, width)}: 32-bit floats, and half floats of the channels in `halves`.
    The file appears complete or not at all."""
    names = list(channels)
    pixels = np.stack([np.asarray(channels[name], np.float32) for name in names], axis=-1)
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, "float")
    spec.channelnames = names
    if halves:
        spec.channelformats = tuple(oiio.TypeDesc("half" if name in halves else "float") for name in names)
    for name, value in (attributes or {}).items():
        spec.attribute(name, value)
    spec.attribute("compression", compression)
    spec.attribute("oiio:ColorSpace", "scene_linear")
    with replacing(path) as temporary:
        file = oiio.ImageOutput.create("openexr")
        if not file.open(_name_for_oiio(temporary), spec) or not file.write_image(np.ascontiguousarray(pixels)):
            raise DriverError(ExitCode.OUTPUT, f"{path}: {_error_of(file)}")
        if not file.close():
            raise DriverError(ExitCode.OUTPUT, f"{path}: {_error_of(file)}")
