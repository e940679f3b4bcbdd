"""Functions of all end-to-end cases: running the program, reading EXR files with OpenImageIO, scoring and asserting.

A case prints one line per assertion: "ok WHAT" or "FAILED WHAT: FOUND". `expected` holds what it must print, so a case
that ends early fails too.
"""

import os
import pathlib
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))
from tests.bench.relmse import relative_squares

PROGRAM = os.environ["POLYRECON"]
SAMPLES = pathlib.Path(os.environ["POLYRECON_SAMPLES"])


def check(holds, what, found=""):
    print(f"ok {what}" if holds else f"FAILED {what}: {found}", flush=True)


def polyrecon(*words, code=0):
    """Runs the program; any other exit code than the expected one ends the case."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    if done.returncode != code:
        print(f"FAILED polyrecon {' '.join(map(str, words))}: exit code {done.returncode}, not {code}\n{done.stderr}")
        raise SystemExit(1)
    return done


class Part:
    """One part of an EXR file: its header, and its channels as float32 arrays (H, W) by their whole names."""

    def __init__(self, spec, pixels):
        self.spec = spec
        self.name = spec.get_string_attribute("oiio:subimagename")
        self.types = [str(t) for t in spec.channelformats] or [str(spec.format)] * spec.nchannels
        self.window = (
            spec.x,
            spec.y,
            spec.width,
            spec.height,
            spec.full_x,
            spec.full_y,
            spec.full_width,
            spec.full_height,
        )
        self.channels = {name: pixels[..., i] for i, name in enumerate(spec.channelnames)}
        self.attributes = {a.name: a.value for a in spec.extra_attribs}


def read(path):
    """All parts of a file. Half and float samples both arrive exactly."""
    file = oiio.ImageInput.open(str(path))
    if not file:
        raise SystemExit(f"FAILED reading {path}: {oiio.geterror()}")
    parts = []
    while file.seek_subimage(len(parts), 0):
        spec = oiio.ImageSpec(file.spec())
        pixels = file.read_image(len(parts), 0, 0, spec.nchannels, "float")
        if pixels is None:
            raise SystemExit(f"FAILED reading {path}: {file.geterror()}")
        parts.append(Part(spec, pixels.reshape(spec.height, spec.width, spec.nchannels)))
    return parts


def channels(path):
    """All channels of all parts by their whole names."""
    return {name: pixels for part in read(path) for name, pixels in part.channels.items()}


def layer(found, name, of="RGB"):
    """A layer of what channels() gave, (H, W, C) in double precision."""
    return np.stack([found[f"ViewLayer.{name}.{c}"] for c in of], -1).astype(np.float64)


def beauty(path):
    return layer(channels(path), "Combined")


def relative_mse(image, reference_path):
    """Mean of ((x - r)^2 - Var(r)) / (r^2 + 0.01): the reference's own noise does not count."""
    found = channels(reference_path)
    reference = layer(found, "Combined")
    variance = layer(found, "Combined Variance") if "ViewLayer.Combined Variance.R" in found else 0.0
    return float(relative_squares(image, reference, variance).mean())


def same_bits(a, b):
    """Equal as bit patterns, so that NaNs and signs of zero count."""
    return a.shape == b.shape and np.array_equal(
        np.ascontiguousarray(a).view(np.uint32), np.ascontiguousarray(b).view(np.uint32)
    )
