"""Reads and writes EXR files as numpy arrays, with OpenImageIO."""

import os
import pathlib
import tempfile

import numpy as np
import OpenImageIO as oiio

from .errors import DriverError, ExitCode


def read(path, wanted=None):
    """The channels of all parts of a file: {full name: float32 array (height, width)}, in file order.

    If `wanted` is given, only the channels with wanted(name) are read. Of parts that have a name in common, the first
    one counts."""
    file = oiio.ImageInput.open(os.fspath(path))
    if not file:
        raise DriverError(ExitCode.BAD_INPUT, f"{path}: {oiio.geterror()}")
    channels, part = {}, 0
    try:
        while file.seek_subimage(part, 0):
            spec = file.spec()
            names = [name for name in spec.channelnames if name not in channels and (not wanted or wanted(name))]
            if names:
                pixels = file.read_image(part, 0, 0, spec.nchannels, "float")
                if pixels is None:
                    raise DriverError(ExitCode.BAD_INPUT, f"{path}: part {part}: {file.geterror()}")
                pixels = np.asarray(pixels, np.float32).reshape(spec.height, spec.width, spec.nchannels)
                for name in names:
                    channels[name] = pixels[..., spec.channelnames.index(name)]
            part += 1
    finally:
        file.close()
    return channels


def metadata(path):
    """The attributes of the first part: {name: value}."""
    file = oiio.ImageInput.open(os.fspath(path))
    if not file:
        raise DriverError(ExitCode.BAD_INPUT, f"{path}: {oiio.geterror()}")
    attributes = {attribute.name: attribute.value for attribute in file.spec().extra_attribs}
    file.close()
    return attributes


def write(path, channels, attributes=None, compression="zip:2"):
    """Writes one part of 32-bit floats from {name: array (height, width)}. The file appears complete or not at all."""
    names = list(channels)
    pixels = np.stack([np.asarray(channels[name], np.float32) for name in names], axis=-1)
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, "float")
    spec.channelnames = names
    spec.attribute("compression", compression)
    spec.attribute("oiio:ColorSpace", "scene_linear")
    for name, value in (attributes or {}).items():
        spec.attribute(name, value)
    path = pathlib.Path(path)
    try:
        handle, temporary = tempfile.mkstemp(suffix=".exr", prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise DriverError(ExitCode.OUTPUT, f"{path}: {error.strerror}") from error
    os.close(handle)
    try:
        file = oiio.ImageOutput.create(temporary)
        if not file or not file.open(temporary, spec) or not file.write_image(np.ascontiguousarray(pixels)):
            raise DriverError(ExitCode.OUTPUT, f"{path}: {file.geterror() if file else oiio.geterror()}")
        if not file.close():
            raise DriverError(ExitCode.OUTPUT, f"{path}: {file.geterror()}")
        os.replace(temporary, path)
    except BaseException:
        pathlib.Path(temporary).unlink(missing_ok=True)
        raise
