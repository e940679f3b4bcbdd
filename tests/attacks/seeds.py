"""Intact files that attacks begin with: cut-outs of the samples, of all kinds of files that the fuzzer knows, and small
renders of known truth."""

import pathlib

import numpy as np

from pipelines.common import exr
from tests.attacks import exr_bytes

ROOT = pathlib.Path(__file__).resolve().parents[2]
WIDTH, HEIGHT = 48, 32
SAMPLES_PER_PIXEL = 8


def cut_out(path, x, y, width=WIDTH, height=HEIGHT):
    """A File with a rectangle of all channels of an EXR file, and its metadata."""
    channels = {name: plane[y : y + height, x : x + width] for name, plane in exr.read(path).items()}
    extra = [
        (name, "string", value.encode())
        for name, value in exr.metadata(path).items()
        if isinstance(value, str) and name.startswith(("cycles.", "polyrecon/"))
    ]
    return exr_bytes.build([(None, channels, None)], extra=extra)


def scene(width=WIDTH, height=HEIGHT, samples=SAMPLES_PER_PIXEL, seed=1, scale=1.0):
    """A noisy render of known truth: {"truth", "mean", "a", "b", "variance", "albedo", "normal": (3, height, width),
    "depth": (height, width)}."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:height, 0:width].astype(float)
    disc = (x - 0.6 * width) ** 2 + (y - 0.5 * height) ** 2 < (0.3 * height) ** 2
    stripes = np.where(((x // 6) + (y // 9)) % 2 == 0, 0.75, 0.25)
    albedo = np.where(
        disc,
        np.stack([stripes * 0 + 0.2, stripes * 0 + 0.6, stripes * 0 + 0.4]),
        np.stack([stripes, 0.8 * stripes, 1 - stripes]),
    )
    normal = np.where(
        disc,
        np.stack([(x - 0.6 * width) / height, (y - 0.5 * height) / height, 0 * x + 0.8]),
        np.stack([0 * x, 0 * x + 1, 0 * x]),
    )
    depth = np.where(disc, 3.0, 5.0 + y / height)
    light = (0.4 + 0.6 * (x + 1) / width) * np.where(disc, 1.2, 0.8)
    truth = scale * (albedo * light + 0.01)

    def half():
        return (truth * rng.gamma(1.5, 1 / 1.5, (samples // 2, *truth.shape))).mean(0)

    a, b = half(), half()
    return {
        "truth": truth,
        "mean": (a + b) / 2,
        "a": a,
        "b": b,
        "variance": truth**2 / 1.5 / samples,
        "albedo": albedo,
        "normal": normal,
        "depth": depth,
    }


def planes(frame, without=()):
    """The channels of a frame as Blender and `polyrecon merge` name them."""
    layers = {
        "mean": "Combined",
        "variance": "Combined Variance",
        "a": "Combined A",
        "b": "Combined B",
        "albedo": "Denoising Albedo",
        "normal": "Denoising Normal",
    }
    found = {}
    for key, layer in layers.items():
        if key not in without:
            letters = "XYZ" if key == "normal" else "RGB"
            found.update({f"ViewLayer.{layer}.{letter}": frame[key][i] for i, letter in enumerate(letters)})
    if "depth" not in without:
        found["ViewLayer.Denoising Depth.Z"] = frame["depth"]
    if "alpha" in frame:
        found["ViewLayer.Combined.A"] = frame["alpha"]
    if "counts" in frame:
        found["ViewLayer.Debug Sample Count.X"] = frame["counts"]
    return found


def files(more=()):
    """{name: File} of all seeds; `more` are folders with further EXR files, which are taken as they are if small."""
    found = {}
    for path in sorted((ROOT / "samples").glob("*.exr")):
        for x, y in ((20, 30), (120, 60)):
            found[f"{path.stem}_{x}"] = cut_out(path, x, y)
    for path in sorted((ROOT / "tests/fuzz/corpus").glob("*.exr")):
        found.update(_parsed(path))
    for folder in more:
        for path in sorted(pathlib.Path(folder).rglob("*.exr")):
            if path.stat().st_size < 150000:
                found.update(_parsed(path))
    frame = scene()
    frame["alpha"] = np.ones((HEIGHT, WIDTH))
    whole = planes(frame)
    found["plain"] = exr_bytes.build([(None, whole, None)], extra=[("cycles.ViewLayer.samples", "string", b"8")])
    found["halves"] = exr_bytes.build([(None, {name: plane.astype(np.float16) for name, plane in whole.items()}, None)])
    groups = {}
    for name, plane in whole.items():
        groups.setdefault(name.split(".")[1], {})[name] = plane
    found["parts"] = exr_bytes.build([(name, group, None) for name, group in groups.items()])
    found["cropped"] = exr_bytes.build(
        [
            (name, {c: p[4:20, 8:40] for c, p in group.items()} if i % 2 else group, (8, 4) if i % 2 else None)
            for i, (name, group) in enumerate(groups.items())
        ],
        display=(0, 0, WIDTH - 1, HEIGHT - 1),
    )
    found["views"] = exr_bytes.build(
        [(None, {f"{view}.{c.split('.', 1)[1]}": p for view in ("left", "right") for c, p in whole.items()}, None)],
        extra=[("multiView", "stringvector", b"\4\0\0\0left\5\0\0\0right")],
    )
    return found


def _parsed(path):
    try:
        return {path.stem: exr_bytes.parse(path.read_bytes())}
    except (ValueError, AssertionError, IndexError, exr_bytes.struct.error):
        return {}  # A damaged file of the corpus; it is an attack already.
