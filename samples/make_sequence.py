#!/usr/bin/env python3
"""Renders the animation of scenes/parade.py, 10 frames of 160 x 90 pixels, to out/sequence/.

For each --spp N it writes noisy frames `parade_N.####.exr` (8 subsets of one sequence, merged) with Blender's motion
vectors, and references `ref.####.exr` of 256 samples. tests/bench/sequence.py measures with them.

This needs a Python that has the Blender 5 module (pip install bpy==5.0.1) and a build of polyrecon. Ten samples of a
frame take a second on two cores. Renders that are in the work folder already are used again."""

import argparse
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
FRAMES = range(1, 11)


def run(command):
    print("+", " ".join(map(str, command)), flush=True)
    subprocess.run(list(map(str, command)), check=True, stdout=subprocess.DEVNULL)


def parts(stem, frame, count):
    return [stem.with_name(f"{stem.name}.{frame:04d}_{part}.exr") for part in range(count)]


def render(options, name, count, *words):
    """All parts of all frames: name.0001_0.exr, ..."""
    stem = options.work / name
    if all(file.exists() for frame in FRAMES for file in parts(stem, frame, count)):
        return stem
    scene = HERE / "scenes" / "render.py"
    frames = f"--frames={FRAMES[0]}-{FRAMES[-1]}"
    run(
        [
            options.blender5,
            scene,
            "parade",
            f"{stem}.exr",
            "--size=160x90",
            f"--parts={count}",
            frames,
            "--single-part",
            *words,
        ]
    )
    return stem


def merge(options, name, merged, samples):
    for frame in FRAMES:
        target = options.work / f"{merged}.{frame:04d}.exr"
        run(
            [
                options.polyrecon,
                "merge",
                *parts(options.work / name, frame, 8),
                "-o",
                target,
                "--overwrite",
                "--samples",
                samples,
            ]
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--work", type=pathlib.Path, default=HERE.parent / "out" / "sequence", help="folder of the results"
    )
    parser.add_argument("--spp", type=int, nargs="*", default=[8, 64, 128], help="samples of the noisy frames")
    parser.add_argument("--blender5", default=sys.executable, help="Python with bpy 5.0.1")
    parser.add_argument("--polyrecon", default=str(HERE.parent / "build" / "release" / "src" / "polyrecon"))
    options = parser.parse_args()
    options.work = options.work.resolve()
    options.work.mkdir(parents=True, exist_ok=True)
    for spp in options.spp:
        render(options, f"in_{spp}", 8, f"--spp={spp}", "--passes=denoising,vector,samples")
        merge(options, f"in_{spp}", f"parade_{spp}", spp // 8)
    render(options, "seed", 8, "--spp=32", "--seeds")
    merge(options, "seed", "ref", 32)


if __name__ == "__main__":
    main()
