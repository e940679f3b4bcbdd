"""Builds one sample scene inside Blender and renders it.

  with the bpy module:  python3 render.py SCENE OUT.exr [options]
  with Blender itself:  blender -b -Y --factory-startup --python-exit-code 7 -P render.py -- SCENE OUT.exr [options]

OUT.exr becomes OUT_0.exr, OUT_1.exr, ... where --parts is over 1: consecutive pieces of ONE sample sequence, so that
their mean is the ordinary render of --spp samples, or with --seeds renders of --spp samples each with seeds 1, 2, ...
With --frames FIRST-LAST every frame of an animation: OUT.0001.exr or OUT.0001_0.exr, ...
"""

import argparse
import importlib
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import bpy


def arguments():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(prog="render.py")
    parser.add_argument("scene", choices=("study", "glass", "lighthouse", "gallery", "meadow", "fan", "parade"))
    parser.add_argument("out")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--parts", type=int, default=1)
    parser.add_argument("--frames", help="FIRST-LAST")
    parser.add_argument("--seeds", action="store_true")
    parser.add_argument(
        "--passes",
        default="",
        help="comma-separated: denoising, samples, light-groups, shadow, ao, cryptomatte, depth, vector",
    )
    parser.add_argument("--depth", default="32", choices=("16", "32"), help="bits of a stored value")
    parser.add_argument("--codec", default="ZIP")
    parser.add_argument("--denoise", action="store_true", help="also store the picture denoised by Blender (Blender 5)")
    parser.add_argument("--single-part", action="store_true", help="one part for all passes (Blender 5)")
    parser.add_argument("--middle", action="store_true", help="only the middle half of the width and of the height")
    parser.add_argument("--save-blend", help="write the scene here as a .blend file too")
    return parser.parse_args(words)


def choose_passes(view_layer, names):
    view_layer.cycles.denoising_store_passes = "denoising" in names
    view_layer.cycles.pass_debug_sample_count = "samples" in names
    view_layer.use_pass_z = "depth" in names
    view_layer.use_pass_vector = "vector" in names
    view_layer.use_pass_ambient_occlusion = "ao" in names
    if "shadow" in names:
        view_layer.use_pass_shadow = True  # gone since Blender 4
    view_layer.use_pass_cryptomatte_object = "cryptomatte" in names
    view_layer.pass_cryptomatte_depth = 2
    if "light-groups" not in names:
        while view_layer.lightgroups:
            bpy.ops.scene.view_layer_remove_lightgroup()


def choose_output(render, depth, codec, single_part):
    settings = render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5
        settings.media_type = "MULTI_LAYER_IMAGE"
        settings.use_exr_interleave = single_part
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = depth
    settings.exr_codec = codec
    render.use_file_extension = False


def choose_samples(cycles, spp, parts, part):
    """Samples [part, part + 1) * spp / parts of one sequence of spp samples."""
    length = spp // parts
    if hasattr(cycles, "use_sample_subset"):
        cycles.samples = spp
        cycles.use_sample_subset = parts > 1
        cycles.sample_offset = part * length
        cycles.sample_subset_length = length
    else:
        cycles.samples = length
        cycles.sample_offset = part * length


def main():
    options = arguments()
    scene = importlib.import_module(options.scene).build()
    scene.render.resolution_x, scene.render.resolution_y = (int(n) for n in options.size.split("x"))
    scene.render.resolution_percentage = 100
    if options.middle:
        scene.render.use_border = scene.render.use_crop_to_border = True
        scene.render.border_min_x = scene.render.border_min_y = 0.25
        scene.render.border_max_x = scene.render.border_max_y = 0.75
    scene.render.use_freestyle = False
    scene.render.use_persistent_data = True
    scene.render.film_transparent = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = options.denoise
    choose_passes(bpy.context.view_layer, options.passes.split(","))
    choose_output(scene.render, options.depth, options.codec, options.single_part)
    if options.save_blend:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(options.save_blend), check_existing=False)
    stem, extension = os.path.splitext(os.path.abspath(options.out))
    if not options.frames:
        render_parts(scene, options, stem, extension)
        return
    first, last = (int(n) for n in options.frames.split("-"))
    for frame in range(first, last + 1):
        scene.frame_set(frame)
        render_parts(scene, options, f"{stem}.{frame:04d}", extension)


def render_parts(scene, options, stem, extension):
    for part in range(options.parts):
        if options.seeds:
            scene.cycles.seed = part + 1
            choose_samples(scene.cycles, options.spp, 1, 0)
        else:
            scene.cycles.seed = 0
            choose_samples(scene.cycles, options.spp, options.parts, part)
        scene.render.filepath = stem + (f"_{part}" if options.parts > 1 else "") + extension
        bpy.ops.render.render(write_still=True)


main()
