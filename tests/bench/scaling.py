#!/usr/bin/env python3
"""Times `polyrecon denoise` on frames of growing size and prints Markdown tables of seconds and memory.

The frames are a real render, a shipped sample with all its layers, tiled in mirror image to the size requested. Seconds
by phase are the program's own (--report); CPU seconds and peak memory are what the kernel counted for the process.
"""

import argparse
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import OpenImageIO as oiio

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from pipelines.common.denoise_defaults import QUALITIES  # noqa: E402

OUT_OF_MEMORY = 33  # exit code: the limit is too low for the frame, said before any work
BAND = 64  # rows written at a time: the largest frame need not fit into memory here

EXAMPLES = """\
examples:
  tests/bench/scaling.py                                    # draft and standard, 0.25 to 16 Mpx
  tests/bench/scaling.py --sizes 1920x1080 --quality draft standard best
  tests/bench/scaling.py --sizes 640x400 --phases           # where the seconds go
  tests/bench/scaling.py --sizes 5120x3200 --quality draft --max-memory 4G 6G 12G
                                                            # memory is bounded, the picture stays the same to the bit
  tests/bench/scaling.py --sizes 1920x1080 --quality draft --max-memory least 4G --prior
                                                            # the same with a prior
"""


def size(text):
    try:
        width, height = (int(word) for word in text.lower().split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: not of the form WIDTHxHEIGHT") from None
    if width < 1 or height < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be positive")
    return width, height


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, epilog=EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--sizes",
        nargs="+",
        type=size,
        metavar="WxH",
        default=[size(s) for s in ("640x400", "1280x800", "1920x1080", "2560x1600", "5120x3200")],
        help="frames to time (default: 0.25, 1, 2, 4 and 16 Mpx)",
    )
    parser.add_argument("--quality", nargs="+", choices=QUALITIES, default=["draft", "standard"])
    parser.add_argument(
        "--max-memory",
        nargs="+",
        metavar="SIZE",
        default=["4G"],
        help="limits to run each frame under, least: the least that is taken (default: 4G, the program's own); all "
        "must hold and give the same picture",
    )
    parser.add_argument("--prior", action="store_true", help="give each frame its picture of quality draft as prior")
    parser.add_argument("--threads", type=int, default=0, help="threads of the program (default: all processors)")
    parser.add_argument("--phases", action="store_true", help="print the seconds of each phase too")
    parser.add_argument("--sample", type=pathlib.Path, default=ROOT / "samples" / "study_16.exr", metavar="EXR")
    parser.add_argument(
        "--program", type=pathlib.Path, default=ROOT / "build" / "release" / "src" / "polyrecon", metavar="FILE"
    )
    parser.add_argument(
        "--write-frame", type=pathlib.Path, metavar="EXR", help="only write the frame of the first size to this file"
    )
    parser.add_argument("--folder", type=pathlib.Path, help="where the frames go (default: a temporary folder)")
    return parser.parse_args()


def mirrored(length, index):
    """Index into `length` samples that run forth and back without end."""
    index %= 2 * length
    return np.where(index < length, index, 2 * length - 1 - index)


def make_frame(sample, width, height, path):
    """Writes the single-part file `sample`, repeated in mirror image, at the given size; same layers and types."""
    source = oiio.ImageInput.open(str(sample))
    if not source:
        sys.exit(f"{sample}: {oiio.geterror()}")
    spec = oiio.ImageSpec(source.spec())
    tile = source.read_image(0, 0, 0, spec.nchannels, "float")
    if tile is None:
        sys.exit(f"{sample}: {source.geterror()}")
    columns = mirrored(spec.width, np.arange(width))
    rows = mirrored(spec.height, np.arange(height))
    spec.width, spec.height, spec.x, spec.y = width, height, 0, 0
    spec.full_width, spec.full_height, spec.full_x, spec.full_y = width, height, 0, 0
    target = oiio.ImageOutput.create(str(path))
    if not target.open(str(path), spec):
        sys.exit(f"{path}: {target.geterror()}")
    for y in range(0, height, BAND):
        band = np.ascontiguousarray(tile[rows[y : y + BAND]][:, columns])
        if not target.write_scanlines(y, min(y + BAND, height), 0, band):
            sys.exit(f"{path}: {target.geterror()}")
    if not target.close():
        sys.exit(f"{path}: {target.geterror()}")


def pixel_hash(path):
    """A hash of every channel as stored, so that two pictures with one hash are equal to the bit."""
    found = hashlib.sha256()
    source = oiio.ImageInput.open(str(path))
    spec = source.spec()
    for y in range(0, spec.height, BAND):
        band = source.read_scanlines(y, min(y + BAND, spec.height), 0, 0, spec.nchannels, "float")
        found.update(np.ascontiguousarray(band).tobytes())
    return found.hexdigest()


def denoise_command(args, frame, quality, clean):
    command = [args.program, "denoise", "-i", frame, "-o", clean, "--overwrite", "--quality", quality]
    command += ["--progress", "none", "--quiet", "--threads", str(args.threads)]
    prior = prior_of(frame)
    return [*command, "--prior", prior] if prior.exists() else command


def prior_of(frame):
    return frame.with_suffix(".prior.exr")


def make_prior(args, frame):
    subprocess.run([*denoise_command(args, frame, "draft", prior_of(frame)), "--max-memory", "1T"], check=True)


def least_memory(args, frame, quality):
    """The limit that the program says it needs where it gets too little."""
    command = [*denoise_command(args, frame, quality, frame.with_suffix(".clean.exr")), "--max-memory", "1M"]
    asked = re.search(r"needs --max-memory (\w+)", subprocess.run(command, capture_output=True, text=True).stderr)
    return asked.group(1) if asked else sys.exit(f"{frame}: runs with --max-memory 1M")


def bytes_of(max_memory):
    units = "KMGT"
    unit = units.find(max_memory[-1].upper())
    return int(max_memory) if unit < 0 else int(max_memory[:-1]) << 10 * (unit + 1)


def run(args, frame, quality, max_memory):
    """One run in a process of its own: its exit code, resource usage, report and the hash of the picture."""
    clean, report = frame.with_suffix(".clean.exr"), frame.with_suffix(".json")
    command = [*denoise_command(args, frame, quality, clean), "--max-memory", max_memory, "--report", report]
    process = subprocess.Popen([str(word) for word in command])
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        return process.returncode, usage, None, None
    picture = pixel_hash(clean)
    clean.unlink()
    return 0, usage, json.loads(report.read_text()), picture


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def header():
    row("frame", "Mpx", "quality", "--max-memory", "reconstruction s", "all s", "CPU s", "µs CPU/px", "px/s", "peak MB")
    row("---", "---:", "---", *["---:"] * 7)


def print_row(width, height, quality, max_memory, code, usage, report):
    pixels, cpu = width * height, usage.ru_utime + usage.ru_stime
    cells = [f"{width} x {height}", f"{pixels / 1e6:.2f}", quality, max_memory]
    if code:
        cells += [f"exit code {code}", "", f"{cpu:.1f}", "", ""]
    else:
        seconds = report["seconds"]
        cells += [f"{seconds['reconstruct']:.1f}", f"{seconds['total']:.1f}", f"{cpu:.1f}"]
        cells += [f"{cpu / pixels * 1e6:.1f}", f"{report['pixels_per_second']:.0f}"]
    row(*cells, f"{usage.ru_maxrss * 1024 / 1e6:.0f}")


def print_phases(runs):
    phases = [phase["phase"] for phase in runs[0][1]["phases"]]
    print()
    row("frame, quality", "read", *phases, "write")
    row("---", *["---:"] * (len(phases) + 2))
    for name, report in runs:
        seconds = report["seconds"]
        row(
            name,
            f"{seconds['read']:.2f}",
            *[f"{phase['seconds']:.2f}" for phase in report["phases"]],
            f"{seconds['write']:.2f}",
        )


def time_frame(args, frame, width, height, quality):
    """Runs one frame under every limit of memory. Returns the reports, and whether all went as it should."""
    good, reports, pictures = True, [], []
    for limit in args.max_memory:
        max_memory = least_memory(args, frame, quality) if limit == "least" else limit
        code, usage, report, picture = run(args, frame, quality, max_memory)
        print_row(width, height, quality, max_memory, code, usage, report)
        if code:
            good = good and code == OUT_OF_MEMORY
            continue
        if usage.ru_maxrss * 1024 > bytes_of(max_memory):
            print(f"{width} x {height}, {quality}: takes more than {max_memory}", file=sys.stderr)
            good = False
        reports.append((f"{width} x {height}, {quality}", report))
        pictures.append(picture)
    if len(set(pictures)) > 1:
        print(f"{width} x {height}, {quality}: the limit of memory shows in the picture", file=sys.stderr)
    return reports, good and len(set(pictures)) <= 1


def time_frames(args, folder):
    good, reports = True, []
    header()
    for width, height in args.sizes:
        frame = folder / f"frame_{width}x{height}.exr"
        make_frame(args.sample, width, height, frame)
        if args.prior:
            make_prior(args, frame)
        for quality in args.quality:
            found, as_it_should = time_frame(args, frame, width, height, quality)
            reports += found
            good = good and as_it_should
        frame.unlink()
        prior_of(frame).unlink(missing_ok=True)
    if args.phases and reports:
        print_phases(reports)
    if good and len(args.max_memory) > 1:
        print("\nUnder every limit of memory that suffices the picture is the same, bit for bit.")
    return good


def main():
    args = arguments()
    if args.write_frame:
        make_frame(args.sample, *args.sizes[0], args.write_frame)
        return
    if not shutil.which(args.program):
        sys.exit(f"{args.program}: not there; build it (cmake --preset release) or name it by --program")
    with tempfile.TemporaryDirectory(dir=args.folder, prefix="polyrecon_scaling_") as folder:
        load = os.getloadavg()[0]
        print(f"{os.cpu_count()} processors, load average {load:.1f} before the first run\n", flush=True)
        sys.exit(0 if time_frames(args, pathlib.Path(folder)) else 1)


if __name__ == "__main__":
    main()
