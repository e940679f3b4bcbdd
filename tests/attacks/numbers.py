"""Frames whose numbers are wrong, extreme, or contradict each other, in any pass."""

import random

import numpy as np

from pipelines.common import exr
from tests.attacks import exr_bytes, seeds

NAME = "numbers"
BEYOND = 1e15  # What counts as not finite.
NOTED_ENERGY = 0.05  # Share of the energy that may change without a note.
LOST_ENERGY = 0.5  # Share from which on there is no result.
SIZES = ((48, 32), (64, 48), (33, 17), (1, 1), (1, 40), (40, 1), (2, 2), (3, 7), (64, 2), (9, 300))
VALUES = (
    0.0,
    -0.0,
    float("nan"),
    float("inf"),
    float("-inf"),
    -1.0,
    1e-42,
    1e-30,
    1e-20,
    1e10,
    1e14,
    1e16,
    1e30,
    3.4e38,
    65504.0,
    7e4,
    1.0,
    255.0,
)
FACTORS = (-1.0, 0.0, 1e-30, 1e-10, 1e-4, 0.01, 0.5, 0.9, 1.1, 2.0, 3.0, 100.0, 1e4, 1e10, 1e20)
SCALES = (1e-30, 1e-20, 1e-10, 1e-6, 1e-3, 1e3, 1e6, 1e10, 1e13, 1e20, 1e30)


def where(shape, rng):
    """A random mask of an image, and what it is called."""
    height, width = shape
    how = rng.randrange(7)
    mask = np.zeros(shape, bool)
    if how == 0:
        mask[:] = True
    elif how == 1:
        mask = np.random.default_rng(rng.randrange(2**32)).random(shape) < rng.choice((0.003, 0.05, 0.3, 0.9))
    elif how == 2:
        mask[rng.randrange(height)] = True
    elif how == 3:
        mask[:, rng.randrange(width)] = True
    elif how == 4:
        x, y = rng.randrange(width), rng.randrange(height)
        mask[y : y + 1 + height // 2, x : x + 1 + width // 2] = True
    elif how == 5:
        mask[rng.randrange(height), rng.randrange(width)] = True
    else:
        mask[: height // 2] = True
    return mask, ("all", "random", "row", "column", "block", "pixel", "half")[how]


def changed(target, how, value, factor, seed):
    """The values of a pass after one change, and what the change is called."""
    with np.errstate(all="ignore"):
        if how < 2:
            return np.full_like(target, value), f"set {value:g}"
        if how == 2:
            return target * factor, f"times {factor:g}"
        if how == 3:
            return target[..., ::-1], "mirrored"
        if how == 4:
            return np.random.default_rng(seed).random(target.shape) * factor, f"random {factor:g}"
        return target + factor, f"plus {factor:g}"


def damage(frame, rng):
    """Changes one pass of a frame in place; returns what was done."""
    key = rng.choice(
        ("mean", "a", "b", "ab", "variance", "variance", "albedo", "normal", "depth", "alpha", "counts", "all")
    )
    keys = {"ab": ("a", "b"), "all": ("mean", "a", "b")}.get(key, (key,))
    mask, place = where(frame["depth"].shape, rng)
    channel = rng.choice((slice(None), slice(None), 0, 2))
    how, value, factor, seed = rng.randrange(6), rng.choice(VALUES), rng.choice(FACTORS), rng.randrange(2**32)
    for one in keys:
        target = frame[one][channel] if frame[one].ndim == 3 else frame[one]
        values, what = changed(target, how, value, factor, seed)
        target[...] = np.where(mask, values, target)
    return f"{key} {what} in {place}" + ("" if isinstance(channel, slice) else f" of channel {channel}")


def frame_of(rng):
    """A damaged frame: its channels, and what was done."""
    width, height = rng.choice(SIZES) if rng.random() < 0.5 else SIZES[0]
    scale = rng.choice(SCALES) if rng.random() < 0.3 else 1.0
    with np.errstate(all="ignore"):
        frame = seeds.scene(width, height, seed=rng.randrange(1000), scale=scale)
    frame["alpha"], frame["counts"] = np.ones((height, width)), np.full((height, width), 8.0)
    words = [f"{width} x {height} at {scale:g}"]
    for _ in range(rng.choice((1, 1, 2, 3))):
        words.append(damage(frame, rng))
    without = rng.choice(
        (
            (),
            (),
            ("a", "b"),
            ("variance",),
            ("a", "b", "variance"),
            ("b",),
            ("albedo", "normal", "depth"),
            ("a", "b", "variance", "albedo", "normal", "depth"),
        )
    )
    if rng.random() < 0.3:
        del frame["counts"]
    if rng.random() < 0.3:
        del frame["alpha"]
    half = rng.random() < 0.2
    with np.errstate(all="ignore"):
        channels = {
            name: plane.astype(np.float16 if half else np.float32)
            for name, plane in seeds.planes(frame, without).items()
        }
    return channels, ", ".join(words) + f"{' half' if half else ''} without {without}"


def finite(channels, name):
    """The values of a channel, and where they count as finite."""
    values = channels[name].astype(np.float64)
    if channels[name].dtype == np.float16:
        values = np.where(np.isposinf(values), 65504, values)
    return values, np.isfinite(values) & (np.abs(values) <= BEYOND)


def faults_of_result(given, folder, notes):
    """What is wrong with the files of a successful run."""
    wrong = []
    result = exr.read(folder / "out.exr")
    beauty = [f"ViewLayer.Combined.{c}" for c in "RGB"]
    for name in beauty:
        before, usable = finite(given, name)
        after = result[name].astype(np.float64)
        if not np.isfinite(after).all():
            wrong.append(f"{name} is not finite in {np.count_nonzero(~np.isfinite(after))} pixels")
            continue
        energy, change = np.abs(before[usable]).sum(), after[usable].sum() - before[usable].sum()
        share = abs(change) / energy if energy > 0 else 0
        if share > LOST_ENERGY * 1.02:
            wrong.append(f"energy of {name} changed by {share:.3g}")
        elif share > NOTED_ENERGY and "energy" not in notes:
            wrong.append(f"energy of {name} changed by {share:.3g} without a note")
    for name, plane in result.items():
        if name in beauty or name == "ViewLayer.Combined.A":
            continue
        kind = np.uint16 if given[name].dtype == np.float16 else np.uint32
        same = plane.astype(given[name].dtype).view(kind) == given[name].view(kind)
        if not (same | np.isnan(given[name])).all():
            wrong.append(f"{name} changed")
    alpha = result.get("ViewLayer.Combined.A")
    if alpha is not None and not ((alpha >= 0) & (alpha <= 1)).all():
        wrong.append(f"alpha from {alpha.min()} to {alpha.max()}")
    for path, low in (("e.exr", 0), ("s.exr", 0)):
        for name, plane in exr.read(folder / path).items():
            if not (np.isfinite(plane) & (plane >= low)).all():
                wrong.append(f"{path} {name} is negative or not finite")
    return wrong


def attack(program, tally, count, more):
    rng = random.Random(tally.seed)
    path = program.folder / "in.exr"
    for number in range(count):
        if tally.is_over():
            break
        program.clear()
        given, what = frame_of(rng)
        exr_bytes.write(path, given)
        (program.folder / "second.exr").write_bytes(path.read_bytes())
        tally.inputs += 1
        quality = rng.choice(("draft", "draft", "standard"))
        arguments = [
            "denoise",
            "-i",
            "in.exr",
            "-o",
            "out.exr",
            "--quality",
            quality,
            "--error-map",
            "e.exr",
            "--sample-map",
            "s.exr",
            "--budget",
            "4",
            "--samples",
            "8",
            "--report",
            "r.json",
            "--alpha",
            "--progress",
            "none",
        ]
        outcome = program.run(arguments)
        wrong = outcome.faults(tally.memory) + [f"left {name}" for name in program.left_over()]
        if outcome.code == 0 and not wrong:
            wrong += faults_of_result(given, program.folder, outcome.out.decode())
        label = f"{number} {what}"
        tally.count(outcome, wrong, label, [path])
        others = (
            ["inspect", "in.exr", "--json"],
            ["preview", "in.exr", "-o", "p.png"],
            ["view", "in.exr", "-o", "v.html"],
            ["merge", "in.exr", "second.exr", "-o", "m.exr"],
            ["compare", "in.exr", "in.exr"],
        )
        for other in rng.sample(others, min(len(others), tally.commands // 2)):
            outcome = program.run(other)
            tally.count(outcome, outcome.faults(tally.memory), f"{label} {other[0]}", [path])
