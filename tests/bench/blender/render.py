"""Renders a .blend file with Cycles for the bench. Needs a Python that has the module bpy.

  render.py SCENE.blend OUT.exr --spp 64 [--parts 8] [--seed 7] [--threshold 0.02] [--denoise] [--timing FILE]

With --parts the files are OUT_0.exr, OUT_1.exr, ...: consecutive pieces of one sample sequence. With --threshold Cycles
samples adaptively; with --denoise it runs Open Image Denoise. The file of --timing holds the seconds of rendering as
JSON: {"wall": S, "cpu": S}."""

import argparse
import json
import os
import time

import bpy


def arguments():
    parser = argparse.ArgumentParser(prog="render.py")
    parser.add_argument("scene")
    parser.add_argument("out")
    parser.add_argument("--spp", type=int, required=True)
    parser.add_argument("--parts", type=int, default=1)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--threshold", type=float)
    parser.add_argument("--denoise", action="store_true")
    parser.add_argument("--features", action="store_true", help="store the denoising features")
    parser.add_argument("--size", help="WIDTHxHEIGHT in place of the file's")
    parser.add_argument("--save-blend", help="also write the scene as a .blend file, with Cycles, size and seed set")
    parser.add_argument("--timing")
    return parser.parse_args()


def choose_output(render):
    settings = render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    render.use_file_extension = False
    render.use_overwrite = True


def choose_sampling(cycles, threshold, denoise):
    """Adaptive sampling and denoiser of Cycles, at their most accurate."""
    cycles.use_adaptive_sampling = threshold is not None
    if threshold is not None:
        cycles.adaptive_threshold = threshold
        cycles.adaptive_min_samples = 0  # Cycles chooses
    cycles.use_denoising = denoise
    if denoise:
        cycles.denoiser = "OPENIMAGEDENOISE"
        cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
        cycles.denoising_prefilter = "ACCURATE"
        cycles.denoising_quality = "HIGH"


def main():
    options = arguments()
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath(options.scene), use_scripts=False)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    if options.size:
        scene.render.resolution_x, scene.render.resolution_y = map(int, options.size.split("x"))
        scene.render.resolution_percentage = 100
    if options.seed is not None:
        scene.cycles.seed, scene.cycles.use_animated_seed = options.seed, False
    if options.save_blend:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(options.save_blend), copy=True)
    scene.render.use_persistent_data = True
    choose_output(scene.render)
    choose_sampling(scene.cycles, options.threshold, options.denoise)
    bpy.context.view_layer.cycles.denoising_store_passes = options.features
    scene.cycles.samples = options.spp
    length = options.spp // options.parts
    scene.cycles.use_sample_subset = options.parts > 1
    scene.cycles.sample_subset_length = length
    stem, extension = os.path.splitext(os.path.abspath(options.out))
    wall, cpu = time.perf_counter(), time.process_time()
    for part in range(options.parts):
        scene.cycles.sample_offset = part * length
        scene.render.filepath = stem + (f"_{part}" if options.parts > 1 else "") + extension
        bpy.ops.render.render(write_still=True)
    if options.timing:
        with open(options.timing, "w", encoding="utf-8") as file:
            json.dump({"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}, file)


main()
