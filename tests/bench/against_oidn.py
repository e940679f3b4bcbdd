#!/usr/bin/env python3
"""Times `polyrecon denoise` against Open Image Denoise (Blender's Denoise node: HDR, albedo, normal, quality high) on
one frame, in turns. Seconds are those of reading, denoising and writing: of the whole command here, of the compositor's
run there, without Blender's start.

    tests/bench/scaling.py --sizes 1920x1080 --sample samples/glass_16.exr --write-frame frame.exr
    build/venv/bin/python tests/bench/against_oidn.py frame.exr            # needs a Python with bpy 5
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAIRS = (("standard", "Accurate"), ("draft", "None"))


def open_image_denoise(frame, size, prefilter, target):
    """In a process of its own, of which stdout gets the seconds."""
    import bpy

    tree = bpy.data.node_groups.new("Denoise", "CompositorNodeTree")
    scene = bpy.context.scene
    scene.compositing_node_group = tree
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    output, source, denoise = map(tree.nodes.new, ("NodeGroupOutput", "CompositorNodeImage", "CompositorNodeDenoise"))
    source.image = bpy.data.images.load(str(frame.resolve()))
    for name, value in (("HDR", True), ("Prefilter", prefilter), ("Quality", "High")):
        denoise.inputs[name].default_value = value
    for name, inlet in (("Noisy Image", "Image"), ("Denoising Albedo", "Albedo"), ("Denoising Normal", "Normal")):
        tree.links.new(source.outputs.get(name) or source.outputs["Combined"], denoise.inputs[inlet])
    tree.links.new(denoise.outputs["Image"], output.inputs["Image"])
    settings = scene.render
    settings.resolution_x, settings.resolution_y = size
    settings.resolution_percentage = 100
    settings.image_settings.media_type = "IMAGE"
    settings.image_settings.file_format = "OPEN_EXR"
    settings.image_settings.color_depth = "32"
    settings.filepath = str(target)
    begin = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    print(time.perf_counter() - begin, flush=True)
    os._exit(0)  # Blender says more as it ends


def seconds_of_oidn(frame, size, prefilter, folder):
    command = [
        sys.executable,
        __file__,
        frame,
        "--size",
        "x".join(map(str, size)),
        "--prefilter",
        prefilter,
        "--target",
        folder / "oidn.exr",
    ]
    printed = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    return float(printed.splitlines()[-1])


def seconds_of_polyrecon(program, frame, quality, folder):
    begin = time.perf_counter()
    subprocess.run(
        [program, "denoise", "-i", frame, "-o", folder / "ours.exr", "--overwrite", "--quality", quality, "-q"],
        check=True,
    )
    return time.perf_counter() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frame", type=pathlib.Path)
    parser.add_argument("--size", default="1920x1080", help="of the frame (%(default)s)")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/src/polyrecon")
    parser.add_argument("--prefilter", help=argparse.SUPPRESS)
    parser.add_argument("--target", type=pathlib.Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    size = tuple(map(int, options.size.split("x")))
    if options.prefilter:
        open_image_denoise(options.frame, size, options.prefilter, options.target)
        return
    print("| polyrecon | s | Open Image Denoise, prefilter | s | ratio |\n|---|---:|---|---:|---:|")
    with tempfile.TemporaryDirectory(dir=os.path.dirname(os.path.abspath(options.frame))) as folder:
        folder = pathlib.Path(folder)
        for quality, prefilter in PAIRS:
            ours, theirs = [], []
            for _ in range(options.turns):
                ours.append(seconds_of_polyrecon(options.program, options.frame, quality, folder))
                theirs.append(seconds_of_oidn(options.frame, size, prefilter, folder))
            a, b = statistics.median(ours), statistics.median(theirs)
            print(f"| {quality} | {a:.1f} | {prefilter.lower()} | {b:.1f} | {a / b:.2f} |", flush=True)


if __name__ == "__main__":
    main()
