#!/usr/bin/env python3
"""Measures what is done with files that are not one ordinary picture, and writes the table of docs/reference/inputs.md.

Each kind of file is made from a small scene of known truth (numpy, 160 x 96 pixels, 16 samples a pixel), denoised by
default settings, and compared with the truth. --before names an earlier program, whose errors stand next to those of
the present one. Needs numpy and OpenImageIO's Python module. A few minutes."""

import argparse
import os
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio
from accuracy import ROOT, table, write_between
from relmse import relative_squares

WIDTH, HEIGHT = 160, 96
FULL = (0, 0, WIDTH, HEIGHT)  # a window: left, top, right, bottom; right and bottom are outside
SAMPLES = 16
NOISE = 4  # variance of one sample, relative to the square of its mean
SUBPIXELS = 4
LIGHT = np.array([-0.4, 0.8, 0.45]) / np.linalg.norm([-0.4, 0.8, 0.45])
BALLS = ((45, 38, 20, (0.7, 0.15, 0.1)), (80, 48, 16, (0.2, 0.6, 0.25)), (115, 34, 24, (0.3, 0.35, 0.8)))
HORIZON = 42


def scene(move=0.0):
    """Three striped balls before a chequered floor and an empty background. The balls stand `move` pixels to the right.
    The floor goes on from the last column to the first one."""
    steps = (np.arange(SUBPIXELS) + 0.5) / SUBPIXELS
    x = (np.arange(WIDTH)[:, None] + steps).ravel()[None, :]
    y = (np.arange(HEIGHT)[:, None] + steps).ravel()[:, None]
    albedo, normal = np.zeros((y.size, x.size, 3)), np.zeros((y.size, x.size, 3))
    depth, shadow = np.zeros((y.size, x.size)), np.ones((y.size, x.size))
    floor = np.broadcast_to(y > HORIZON, depth.shape)
    distance = 300 / np.maximum(y - HORIZON + 8, 1)
    chequered = (np.floor(x / 10) + np.floor(distance)) % 2 > 0
    albedo[floor] = np.where(chequered[..., None], (0.75, 0.7, 0.6), (0.15, 0.2, 0.3))[floor]
    normal[floor], depth[floor] = (0, 1, 0), np.broadcast_to(distance, depth.shape)[floor]
    for left, top, radius, _ in BALLS:
        far = np.hypot(x - left - move - 0.3 * radius, (y - top - radius) * 3) / radius
        shadow *= np.where(floor, 1 / (1 + np.exp(-8 * (far - 1))), 1)
    for left, top, radius, color in BALLS:
        u, v = (x - left - move) / radius, (y - top) / radius
        inside = u * u + v * v < 1
        w = np.sqrt(np.maximum(1 - u * u - v * v, 0))
        stripes = 0.75 + 0.25 * np.sin(16 * v + 8 * u)
        albedo[inside] = (np.array(color) * stripes[..., None])[inside]
        normal[inside] = np.stack(np.broadcast_arrays(u, -v, w), -1)[inside]
        depth[inside], shadow[inside] = (4 - w)[inside], 1
    alpha = (depth > 0).astype(float)
    lit = 0.25 + 1.2 * shadow * np.clip(normal @ LIGHT, 0, None)
    passes = {"beauty": albedo * lit[..., None], "albedo": albedo, "N": normal, "Z": depth, "A": alpha}
    return {name: mean_over_subpixels(values) for name, values in passes.items()}


def mean_over_subpixels(values):
    shape = (HEIGHT, SUBPIXELS, WIDTH, SUBPIXELS, -1)
    return values.reshape(shape).mean((1, 3)).squeeze().astype(np.float32)


def with_background(passes):
    """The scene before a grey wall that no feature shows."""
    return {**passes, "beauty": passes["beauty"] + 0.3 * (1 - passes["A"])[..., None], "A": np.ones_like(passes["A"])}


def noisy(mean, rng, samples=SAMPLES):
    shape = samples / NOISE
    return (mean * rng.gamma(shape, 1 / shape, mean.shape[:2])[..., None]).astype(np.float32)


def relmse(image, truth, mask=None):
    error = relative_squares(image, truth).mean(-1)
    return error[mask].mean() if mask is not None else error.mean()


def cut(image, window):
    return image[window[1] : window[3], window[0] : window[2]]


def channels_of(passes, layers):
    """{channel: values} of some passes; layers: {pass: name of its layer}, an empty name has no prefix."""
    channels = {}
    for name, layer in layers.items():
        values = passes[name]
        words = {"N": "XYZ", "A": "A", "Z": "Z"}.get(name, "RGB")
        words = "Y" if values.ndim == 2 and words == "RGB" else words
        planes = [values] if values.ndim == 2 else np.moveaxis(values, -1, 0)
        channels.update({f"{layer}.{word}" if layer else word: plane for word, plane in zip(words, planes)})
    return channels


ORDINARY = {"beauty": "", "A": "", "albedo": "albedo", "N": "N", "Z": ""}


def write(path, *parts, kind="float"):
    """Writes parts (name, {channel: values}, window) of one display window."""
    specs = []
    for name, channels, (left, top, right, bottom) in parts:
        spec = oiio.ImageSpec(right - left, bottom - top, len(channels), kind)
        spec.channelnames = tuple(channels)
        spec.x, spec.y, spec.full_width, spec.full_height = left, top, WIDTH, HEIGHT
        if name:
            spec["oiio:subimagename"] = name
        specs.append(spec)
    file = oiio.ImageOutput.create(str(path))
    for k, (spec, (_, channels, window)) in enumerate(zip(specs, parts)):
        opened = file.open(str(path), spec, "AppendSubimage") if k else file.open(str(path), tuple(specs))
        pixels = np.stack([cut(values, window) for values in channels.values()], -1)
        if not opened or not file.write_image(np.ascontiguousarray(pixels, np.float32)):
            raise OSError(file.geterror())
    file.close()


def write_ordinary(path, passes, layers=None, window=FULL, **options):
    write(path, ("", channels_of(passes, layers or ORDINARY), window), **options)


def read(path, layer=""):
    """RGB of a layer in the display window; 0 beyond its data window."""
    wanted = [f"{layer}.{c}" if layer else c for c in "RGB"]
    for part in range(8):
        image = oiio.ImageBuf(str(path), part, 0)
        if image.has_error or not image.initialized:
            break
        spec = image.spec()
        if wanted[0] in spec.channelnames:
            out = np.zeros((HEIGHT, WIDTH, 3))
            pixels = image.get_pixels(oiio.FLOAT)[..., [spec.channelnames.index(name) for name in wanted]]
            out[spec.y : spec.y + spec.height, spec.x : spec.x + spec.width] = pixels
            return out
    raise KeyError(f"{path}: {wanted[0]}")


def box_of(values):
    rows, columns = np.nonzero(np.abs(values).reshape(HEIGHT, WIDTH, -1).max(-1))
    return columns.min(), rows.min(), columns.max() + 1, rows.max() + 1


# Each kind of file: a function of a program to run and random numbers. It returns the error of the noisy picture, that
# of the result, and that of the result of the same frame in an ordinary file, or with the option that the line names.


def auto_crop(run, rng):
    """parts with data windows of their own (auto-crop), under a glow that no feature shows"""
    clean = scene()
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    glow = np.where(rows < HORIZON, 0.3 * np.exp(-(((rows - 10) / 8) ** 2 + ((columns - 80) / 30) ** 2)), 0)
    clean["beauty"] += (np.where(glow > 1e-3, glow, 0) * (1 - clean["A"]))[..., None].astype(np.float32)
    passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
    parts = []
    for name, layers in (
        ("beauty", {"beauty": "", "A": ""}),
        ("albedo", {"albedo": ""}),
        ("N", {"N": ""}),
        ("Z", {"Z": ""}),
    ):
        channels = channels_of(passes, layers)
        parts.append((name, channels, box_of(np.stack(list(channels.values()), -1))))
    write("in.exr", *parts)
    write_ordinary("one.exr", passes)
    results = [read(run("denoise", "-i", name)) for name in ("in.exr", "one.exr")]
    return [relmse(image, clean["beauty"]) for image in (passes["beauty"], *results)]


def file_for_each_pass(run, rng):
    """a file for each pass, `shot_albedo.0001.exr` next to `shot_beauty.0001.exr`"""
    clean = with_background(scene())
    passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
    for name, word in (("beauty", "beauty"), ("albedo", "albedo"), ("N", "normal"), ("Z", "depth")):
        write_ordinary(f"shot_{word}.0001.exr", {"beauty": passes[name]}, {"beauty": ""})
    write_ordinary("one.exr", passes)
    results = [read(run("denoise", "-i", name)) for name in ("shot_beauty.0001.exr", "one.exr")]
    return [relmse(image, clean["beauty"]) for image in (passes["beauty"], *results)]


def stereo(run, rng):
    """two stereo views in one file; the right one"""
    eyes = {"": with_background(scene()), "right": with_background(scene(4))}
    channels = {}
    for view, clean in eyes.items():
        passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
        front = f"{view}." if view else ""
        names = {"beauty": view, "A": view, "albedo": f"{front}albedo", "N": f"{front}N", "Z": f"{front}depth"}
        channels.update(channels_of(passes, names))
    write("in.exr", ("", channels, FULL))
    write_ordinary("one.exr", passes)
    results = [read(run("denoise", "-i", "in.exr"), "right"), read(run("denoise", "-i", "one.exr"))]
    return [relmse(image, clean["beauty"]) for image in (passes["beauty"], *results)]


def shadow_catcher(run, rng):
    """`--aov` with a layer that is noisy where the beauty is black (a shadow catcher)"""
    clean = scene()
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    shadow = (0.8 - 0.6 / (1 + ((columns - 80) / 40) ** 2 + ((rows - 20) / 15) ** 2)).astype(np.float32)
    catcher = np.repeat((shadow * (1 - clean["A"]))[..., None], 3, -1)
    caught = noisy(catcher, rng)
    passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
    channels = {**channels_of(passes, ORDINARY), **{f"Shadow Catcher.{c}": caught[..., k] for k, c in enumerate("RGB")}}
    write("in.exr", ("", channels, FULL))
    write_ordinary("one.exr", {**passes, "beauty": caught, "A": 1 - clean["A"]}, {"beauty": "", "A": ""})
    results = [read(run("denoise", "-i", "in.exr", "--aov", "Shadow Catcher"), "Shadow Catcher"),
               read(run("denoise", "-i", "one.exr"))]  # fmt: skip
    return [relmse(image, catcher) for image in (caught, *results)]


def grey_albedo(run, rng):
    """an albedo of one channel"""
    clean = with_background(scene())
    grey = clean["albedo"].mean(-1)
    clean["beauty"] = np.repeat(clean["beauty"].mean(-1, keepdims=True), 3, -1)
    passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
    write_ordinary("in.exr", {**passes, "albedo": grey})
    write_ordinary("one.exr", {**passes, "albedo": np.repeat(grey[..., None], 3, -1)})
    results = [read(run("denoise", "-i", name)) for name in ("in.exr", "one.exr")]
    return [relmse(image, clean["beauty"]) for image in (passes["beauty"], *results)]


def half_overflow(run, rng):
    """a lamp beyond the largest half float, stored as +Inf; its own pixels"""
    clean = with_background(scene())
    clean["beauty"][10:14, 70:76] = 65504
    passes = {**clean, "beauty": np.minimum(noisy(clean["beauty"], rng), 65504)}
    passes["beauty"][10:14, 70:76] = 65504
    write_ordinary("one.exr", passes, kind="half")
    above = passes["beauty"].copy()
    above[10:14, 70:76] = np.inf
    write_ordinary("in.exr", {**passes, "beauty": above}, kind="half")
    results = [read(run("denoise", "-i", name)) for name in ("in.exr", "one.exr")]
    lamp = clean["beauty"][..., 0] == 65504
    return [np.nan, *(relmse(image, clean["beauty"], lamp) for image in results)]


def transparent(run, rng):
    """transparent film: empty where alpha is 0, light 30 times as strong"""
    clean = scene()
    alpha = (rng.binomial(SAMPLES, clean["A"]) / SAMPLES).astype(np.float32)
    color = 30 * clean["beauty"] / np.maximum(clean["A"], 1e-6)[..., None]
    passes = {**clean, "beauty": noisy(color, rng) * alpha[..., None], "A": alpha}
    write_ordinary("in.exr", passes)
    result = read(run("denoise", "-i", "in.exr"))
    return [relmse(image, 30 * clean["beauty"]) for image in (passes["beauty"], result)]


def render_region(run, rng):
    """a render region that is black outside; its outer 6 pixels, next to the same cropped"""
    clean, region = with_background(scene()), (30, 20, 130, 80)
    passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
    write_ordinary("one.exr", passes, window=region)
    inside = np.zeros((HEIGHT, WIDTH), bool)
    cut(inside, region)[:] = True
    write_ordinary("in.exr", {name: (values.T * inside.T).T for name, values in passes.items()})
    ring = inside.copy()
    cut(ring, (36, 26, 124, 74))[:] = False
    results = [read(run("denoise", "-i", name)) for name in ("in.exr", "one.exr")]
    return [relmse(image, clean["beauty"], ring) for image in (passes["beauty"], *results)]


def light_map(run, rng):
    """a light map without features; the outer 2 pixels of its islands"""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    alpha = ((rows % 24 > 2) & (columns % 32 > 2)).astype(np.float32)
    level = rng.uniform(0.1, 1.2, (HEIGHT // 24, WIDTH // 32)).repeat(24, 0).repeat(32, 1)
    clean = (level * (1 + 0.4 * np.sin(columns / 9) * np.cos(rows / 7)) * alpha)[..., None] * np.array([1, 0.9, 0.75])
    clean = clean.astype(np.float32)
    outer = (alpha > 0) & ((rows % 24 < 5) | (rows % 24 > 21) | (columns % 32 < 5) | (columns % 32 > 29))
    image = noisy(clean, rng)
    write_ordinary("in.exr", {"beauty": image, "A": alpha}, {"beauty": "", "A": ""})
    return [relmse(picture, clean, outer) for picture in (image, read(run("denoise", "-i", "in.exr")))]


def regions(run, rng):
    """four regions of a frame, joined by `polyrecon merge`, next to the whole frame"""
    clean = with_background(scene())
    passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
    boxes = [(0, 0, 80, 48), (80, 0, WIDTH, 48), (0, 48, 80, HEIGHT), (80, 48, WIDTH, HEIGHT)]
    for k, box in enumerate(boxes):
        write_ordinary(f"region{k}.exr", passes, window=box)
    write_ordinary("one.exr", passes)
    joined = run("merge", *(f"region{k}.exr" for k in range(4)))
    results = [read(run("denoise", "-i", name)) for name in (joined, "one.exr")]
    return [relmse(image, clean["beauty"]) for image in (passes["beauty"], *results)]


def panorama(run, rng):
    """`--wrap x`: the outer 4 columns of a panorama, next to the same columns inside of the frame"""
    clean = {name: np.roll(values, WIDTH // 2, 1) for name, values in with_background(scene()).items()}
    passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
    write_ordinary("in.exr", passes)
    write_ordinary("one.exr", {name: np.roll(values, WIDTH // 2, 1) for name, values in passes.items()})
    seam = np.zeros((HEIGHT, WIDTH), bool)
    seam[:, :4] = seam[:, -4:] = True
    results = [read(run("denoise", "-i", "in.exr", "--wrap", "x")),
               np.roll(read(run("denoise", "-i", "one.exr")), WIDTH // 2, 1)]  # fmt: skip
    return [relmse(image, clean["beauty"], seam) for image in (passes["beauty"], *results)]


def frames(run, passes_of_frames, window_of=lambda frame: FULL):
    """Results of the middle one of five frames, with default options and with --frame-radius 0."""
    for frame, passes in enumerate(passes_of_frames, 1):
        write_ordinary(f"shot.{frame:04d}.exr", passes, window=window_of(frame))
    words = ("denoise", "-i", "shot.####.exr", "--frames", "3")
    return [read(run(*words)), read(run(*words, "--frame-radius", "0"))]


def one_seed(run, rng):
    """a sequence that stands still, with one seed for all frames, next to `--frame-radius 0`"""
    clean = with_background(scene())
    passes = {**clean, "beauty": noisy(clean["beauty"], rng)}
    results = frames(run, [passes] * 5)
    return [relmse(image, clean["beauty"]) for image in (passes["beauty"], *results)]


def without_vectors(run, rng):
    """a sequence without motion vectors; balls move 1.5 pixels a frame, next to `--frame-radius 0`"""
    clean = [with_background(scene(1.5 * frame)) for frame in range(5)]
    passes = [{**one, "beauty": noisy(one["beauty"], rng)} for one in clean]
    results = frames(run, passes)
    return [relmse(image, clean[2]["beauty"]) for image in (passes[2]["beauty"], *results)]


def moving_windows(run, rng):
    """a sequence that stands still, seen through windows that move, next to `--frame-radius 0`"""
    clean = with_background(scene())
    passes = [{**clean, "beauty": noisy(clean["beauty"], rng)} for _ in range(5)]
    box = (30, 20, 130, 80)
    mask = np.zeros((HEIGHT, WIDTH), bool)
    cut(mask, box)[:] = True
    results = frames(run, passes, lambda frame: (30 + 6 * (frame - 3), 20, 130 + 6 * (frame - 3), 80))
    return [relmse(image, clean["beauty"], mask) for image in (passes[2]["beauty"], *results)]


KINDS = (
    file_for_each_pass,
    auto_crop,
    grey_albedo,
    stereo,
    shadow_catcher,
    half_overflow,
    transparent,
    render_region,
    light_map,
    regions,
    panorama,
    one_seed,
    without_vectors,
    moving_windows,
)


def runner(program):
    """Runs a command of the program that writes one picture; returns the picture's name."""
    count = 0

    def run(command, *words):
        nonlocal count
        count += 1
        out = f"out{count}.####.exr" if any("#" in word for word in words) else f"out{count}.exr"
        done = subprocess.run([program, command, *words, "-o", out, "--quiet"], capture_output=True, text=True)
        if done.returncode:
            raise subprocess.CalledProcessError(done.returncode, done.args, done.stdout, done.stderr)
        return out.replace("####", "0003")

    return run


def errors(kind, program, seeds):
    """Geometric means over the seeds, or the exit code of a command that failed."""
    found, home = [], pathlib.Path.cwd()
    for seed in range(1, seeds + 1):
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                found.append(kind(runner(program), np.random.default_rng(seed)))
            except subprocess.CalledProcessError as error:
                return f"exit code {error.returncode}"
            finally:
                os.chdir(home)
    return np.exp(np.log(np.maximum(found, 1e-9)).mean(0))


def figure(values, k):
    if isinstance(values, str):
        return values if k == 1 else ""
    return f"{values[k]:.4f}" if k < len(values) and np.isfinite(values[k]) else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--polyrecon", default=str(ROOT / "build" / "release" / "src" / "polyrecon"))
    parser.add_argument("--before", help="an earlier program")
    parser.add_argument("--seeds", type=int, default=3, help="draws of noise; errors are geometric means")
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "docs" / "reference" / "inputs.md")
    parser.add_argument("--only", nargs="*", help="names of kinds; then the table is printed only")
    options = parser.parse_args()
    program, before = (path and os.path.abspath(path) for path in (options.polyrecon, options.before))
    rows = []
    for kind in KINDS:
        if options.only and kind.__name__ not in options.only:
            continue
        now = errors(kind, program, options.seeds)
        earlier = figure(errors(kind, before, options.seeds), 1) if before else ""
        rows.append([kind.__doc__, figure(now, 0), earlier, figure(now, 1), figure(now, 2)])
        print(rows[-1], flush=True)
    text = table(["file", "noisy", "before", "now", "compared with"], rows)
    if options.only:
        print(text)
    else:
        write_between(options.page, "inputs", text, "inputs.py")


if __name__ == "__main__":
    main()
