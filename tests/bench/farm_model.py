#!/usr/bin/env python3
"""Measures what `polyrecon denoise` asks of a machine, fits the model of pipelines/farm to it and writes its constants.

Frames are shipped samples tiled in mirror image: as an ordinary render (the passes of the fit without variance and
halves), as a merge of parts (with both), and the same with passes that are only copied. Each run is a sequence, so that
its peak memory has the next frame in it, which is read meanwhile. A frame larger than those of the fit checks the
model. Frames work alone there; what their neighbours in time add is measured by --neighbours."""

import argparse
import itertools
import json
import multiprocessing
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import OpenImageIO as oiio
import scaling

sys.path.append(str(scaling.ROOT))
from pipelines.common.layer_names import HALF_A_SUFFIX, HALF_B_SUFFIX, SAMPLE_COUNT_PASS, VARIANCE_SUFFIX
from pipelines.farm.requirements import MODEL_FILE, Model, frame_of

FRAMES = 2
RADIUS = 2
SIZES = ((320, 180), (640, 360))
# (layouts, quality, sizes); best takes long, and only its windows differ from standard.
RUNS = (
    (("plain", "merged", "copied"), "draft", SIZES),
    (("plain", "merged", "copied"), "standard", SIZES),
    (("merged",), "best", SIZES[:1]),
)
CHECK = ((960, 540), "standard")  # a size and quality that the fit has not seen
SCALING_SIZE = (640, 360)
THREADS = 2
AOV_BYTES = 2 * 3 * 4.0  # of a pixel of a neighbour: two halves of three floats
TURNS = 3  # of --scaling
TRAITS = (VARIANCE_SUFFIX, HALF_A_SUFFIX, HALF_B_SUFFIX, SAMPLE_COUNT_PASS)


def plain(name):
    return not any(trait + "." in name for trait in TRAITS)


def write_layout(sample, path, wanted, copies):
    """The sample with some of its channels, and with copies of its colour under names that play no role."""
    source = oiio.ImageInput.open(str(sample))
    spec = oiio.ImageSpec(source.spec())
    pixels = source.read_image(0, 0, 0, spec.nchannels, "float")
    kept = [k for k, name in enumerate(spec.channelnames) if wanted(name)]
    names = [spec.channelnames[k] for k in kept]
    colour = [k for k, name in enumerate(spec.channelnames) if name.rpartition(".")[0].endswith("Combined")][:3]
    for copy in range(copies):
        kept += colour
        names += [f"ViewLayer.Mask {copy:02}.{component}" for component in "BGR"]
    spec.nchannels, spec.channelnames, spec.channelformats = len(names), names, ()
    spec.set_format(oiio.HALF)
    target = oiio.ImageOutput.create(str(path))
    if not target.open(str(path), spec) or not target.write_image(np.ascontiguousarray(pixels[..., kept])):
        sys.exit(f"{path}: {target.geterror()}")
    target.close()


def command(program, folder, quality, threads, radius=0):
    words = [program, "denoise", "-i", folder / "in.####.exr", "-o", folder / "out.####.exr", "--overwrite"]
    words += ["--frames", f"1-{frames_of(radius)}", "--frame-radius", radius]
    return [*words, "--quality", quality, "--threads", threads, "--max-memory", "1T", "--progress", "none", "--quiet"]


def frames_of(radius):
    """So many that one frame has all its neighbours, and another one after it."""
    return FRAMES + 2 * radius


def run(program, folder, quality, threads, radius=0):
    """A sequence in one process of its own; memory and seconds are what the kernel counted."""
    child = subprocess.Popen([str(word) for word in command(program, folder, quality, threads, radius)])
    os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
    lines = pathlib.Path(f"/proc/{child.pid}/io").read_text().splitlines()
    traffic = dict(line.split(": ") for line in lines)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        sys.exit(f"{folder}: polyrecon ended with {child.returncode}")
    return {
        "peak": usage.ru_maxrss * 1024,
        "cpu": (usage.ru_utime + usage.ru_stime) / frames_of(radius),
        "read": int(traffic["rchar"]) / frames_of(radius),
        "written": int(traffic["wchar"]) / frames_of(radius),
    }


def inspect(program, path):
    return frame_of(
        json.loads(subprocess.run([program, "inspect", "--json", path], check=True, capture_output=True).stdout)
    )


def apart(function, *arguments):
    """Calls it in a process of its own, so that this one stays small: the peak of a child that it starts begins with
    its own."""
    process = multiprocessing.get_context("fork").Process(target=function, args=arguments)
    process.start()
    process.join()
    if process.exitcode:
        sys.exit(f"{function.__name__} failed")


class Shots:
    """Sequences of links to one frame, made on request."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        sample = scaling.ROOT / "samples" / "study_16.exr"
        self.layouts = {
            "plain": (sample, plain, 0),
            "merged": (sample, lambda name: True, 0),
            "copied": (sample, lambda name: True, 15),
        }

    def get(self, layout, width, height, name=None):
        folder = self.folder / (name or f"{layout}_{width}")
        if not folder.exists():
            folder.mkdir()
            apart(write_layout, self.layouts[layout][0], folder / "layout.exr", *self.layouts[layout][1:])
            apart(scaling.make_frame, folder / "layout.exr", width, height, folder / "in.0001.exr")
            for k in range(2, frames_of(RADIUS) + 1):
                os.link(folder / "in.0001.exr", folder / f"in.{k:04}.exr")
        return folder, inspect(self.program, folder / "in.0001.exr")


def fit(rows, values):
    """Least squares relative to the values, no constant below zero: a column that would be is left out."""
    rows, values = np.asarray(rows, float), np.asarray(values, float)
    used = list(range(rows.shape[1]))
    while True:
        solution, *_ = np.linalg.lstsq(rows[:, used] / values[:, None], np.ones(len(values)), rcond=None)
        if (solution >= 0).all():
            break
        del used[int(solution.argmin())]
    constants = np.zeros(rows.shape[1])
    constants[used] = solution
    return constants


def fit_model(runs):
    qualities = [quality for _, quality, _ in RUNS]

    def sizes(run):
        """Pixels in the place of the run's quality and 0 in the others; values of the channels; values in the fit."""
        frame = run["frame"]
        of_quality = [frame.pixels * (run["quality"] == quality) for quality in qualities]
        return of_quality, frame.pixels * frame.channels, frame.pixels * frame.fit_channels

    memory_rows = [[1, *of_quality, fit_values, values] for of_quality, values, fit_values in map(sizes, runs)]
    memory = fit(memory_rows, [r["peak"] for r in runs])
    # Bound from above, so that the driver's margin is all there for what was not measured.
    memory *= max(r["peak"] / (memory @ row) for r, row in zip(runs, memory_rows))
    seconds = fit([[1, *of_quality, values] for of_quality, values, _ in map(sizes, runs)], [r["cpu"] for r in runs])
    count = len(qualities)
    return {
        "memory": {
            "base": memory[0],
            "per_pixel": dict(zip(qualities, memory[1 : 1 + count])),
            "per_fit_channel": memory[1 + count],
            "per_channel": memory[2 + count],
        },
        "seconds": {
            "start": seconds[0],
            "per_pixel": dict(zip(qualities, seconds[1 : 1 + count])),
            "per_channel": seconds[1 + count],
        },
    }


def rounded(value):
    return {k: rounded(v) for k, v in value.items()} if isinstance(value, dict) else float(f"{value:.4g}")


def side_by_side(program, shots, tasks, threads):
    """So many tasks at once, each in a folder of its own: wall-clock seconds of all and processor seconds, per
    frame."""
    folders = [shots.get("merged", *SCALING_SIZE, name=f"task_{task}")[0] for task in range(tasks)]
    begun = time.monotonic()
    children = [subprocess.Popen(list(map(str, command(program, f, "standard", threads)))) for f in folders]
    cpu = 0.0
    for child in children:
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        cpu += usage.ru_utime + usage.ru_stime
    if any(child.returncode for child in children):
        sys.exit("polyrecon failed")
    frames = tasks * FRAMES
    return (time.monotonic() - begun) / frames, cpu / frames


def measure_scaling(program, shots):
    """Prints a table of medians; returns the parallel part of Amdahl's law of one task, by the clock: the machine must
    be idle."""
    scaling.row("tasks", "threads of each", "CPU s a frame", "wall s a frame")
    scaling.row("---:", "---:", "---:", "---:")
    ways = ((1, 1), (2, 1), (1, 2))
    turns = [[side_by_side(program, shots, *way) for way in ways] for _ in range(TURNS)]
    walls = []
    for way, (tasks, threads) in enumerate(ways):
        wall, cpu = (statistics.median(turn[way][figure] for turn in turns) for figure in (0, 1))
        scaling.row(tasks, threads, f"{cpu:.2f}", f"{wall:.2f}")
        walls.append(wall)
    return min(1.0, 2 * (1 - walls[2] / walls[0]))


def measure_neighbours(program, shots):
    """Prints a table; returns bytes and processor seconds of a pixel and neighbour."""
    folder, frame = shots.get("merged", *SCALING_SIZE)
    alone, joined = (run(program, folder, "draft", THREADS, radius) for radius in (0, RADIUS))
    numbers = range(frames_of(RADIUS))
    in_reach = sum(0 < abs(a - b) <= RADIUS for a in numbers for b in numbers) / len(numbers)
    scaling.row("", "radius 0", f"radius {RADIUS}", "a pixel and neighbour")
    scaling.row("---", *["---:"] * 3)
    extra = (joined["peak"] - alone["peak"]) / frame.pixels / (2 * RADIUS + 2)
    scaling.row("peak MB", *(f"{r['peak'] / 1e6:.0f}" for r in (alone, joined)), f"{extra:.0f} bytes")
    seconds = (joined["cpu"] - alone["cpu"]) / frame.pixels / in_reach
    scaling.row("CPU s a frame", *(f"{r['cpu']:.2f}" for r in (alone, joined)), f"{1e6 * seconds:.2f} us")
    return {"bytes": extra, "bytes_per_aov": AOV_BYTES, "seconds": seconds}


def measure_constants(program, shots):
    runs = []
    for layouts, quality, sizes in RUNS:
        for layout, size in itertools.product(layouts, sizes):
            place, frame = shots.get(layout, *size)
            runs.append({"layout": layout, "quality": quality, "frame": frame, **run(program, place, quality, THREADS)})
    return runs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=scaling.ROOT / "build/release/src/polyrecon")
    parser.add_argument("--model", type=pathlib.Path, default=MODEL_FILE, help="file to write (default: the driver's)")
    parser.add_argument("--scaling", action="store_true", help="only one and two tasks, one and two threads")
    parser.add_argument("--neighbours", action="store_true", help="only what frames before and after add")
    args = parser.parse_args()
    constants = json.loads(args.model.read_text()) if args.model.exists() else {}
    with tempfile.TemporaryDirectory(prefix="polyrecon_farm_model_") as folder:
        shots = Shots(args.program, pathlib.Path(folder))
        if args.scaling:
            constants["parallel_part"] = float(f"{measure_scaling(args.program, shots):.3g}")
            write_model(args.model, constants)
            return
        if args.neighbours:
            constants["neighbour"] = rounded(measure_neighbours(args.program, shots))
            write_model(args.model, constants)
            return
        runs = measure_constants(args.program, shots)
        version = subprocess.run([args.program, "--version"], check=True, capture_output=True, text=True).stdout.strip()
        constants.update(
            made_by=f"tests/bench/farm_model.py, also with --neighbours and with --scaling, {version}",
            **rounded(fit_model(runs)),
        )
        constants.setdefault("parallel_part", 1.0)
        constants.setdefault("neighbour", {"bytes": 0.0, "bytes_per_aov": AOV_BYTES, "seconds": 0.0})
        write_model(args.model, constants)
        size, quality = CHECK
        place, frame = shots.get("merged", *size)
        runs.append(
            {"layout": "merged", "quality": quality, "frame": frame, **run(args.program, place, quality, THREADS)}
        )
        print_runs(runs, Model(args.model))


def write_model(path, constants):
    path.write_text(json.dumps(constants, indent=2) + "\n")


def print_runs(runs, model):
    scaling.row(
        "layout",
        "frame",
        "channels",
        "of the fit",
        "quality",
        "peak MB",
        "model",
        "CPU s",
        "model",
        "MB read",
        "written",
    )
    scaling.row("---", "---", *["---:"] * 2, "---", *["---:"] * 6)
    for r in runs:
        frame = r["frame"]
        scaling.row(
            r["layout"],
            f"{frame.width} x {frame.height}",
            frame.channels,
            frame.fit_channels,
            r["quality"],
            f"{r['peak'] / 1e6:.0f}",
            f"{model.peak_bytes(frame, r['quality'], radius=0) / 1e6:.0f}",
            f"{r['cpu']:.2f}",
            f"{model.cpu_seconds(frame, r['quality'], radius=0):.2f}",
            f"{r['read'] / 1e6:.1f}",
            f"{r['written'] / 1e6:.1f}",
        )
    worst = max(r["peak"] / model.peak_bytes(r["frame"], r["quality"], radius=0) for r in runs)
    print(f"\nworst peak over model: {worst:.3f}")
    if worst > 1.1:
        sys.exit("the model does not fit: its margin of 1.15 is nearly used up")


if __name__ == "__main__":
    main()
