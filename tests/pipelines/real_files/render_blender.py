"""Runs inside Blender: renders a cube under a sky with all of Cycles' passes. render_blender.py OUT SEED DEPTH"""

import sys

import bpy

out, seed, depth = sys.argv[-3:]
bpy.ops.wm.read_factory_settings()
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 24, 100
scene.cycles.samples, scene.cycles.seed = 2, int(seed)
scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
layer = bpy.context.view_layer
for owner in (layer, layer.cycles):
    for p in owner.bl_rna.properties:
        if p.identifier.startswith(("use_pass_", "pass_debug_", "pass_render_")) and p.type == "BOOLEAN":
            setattr(owner, p.identifier, True)
layer.cycles.denoising_store_passes = True
settings = scene.render.image_settings
if hasattr(settings, "media_type"):  # Blender 5
    settings.media_type = "MULTI_LAYER_IMAGE"
settings.file_format = "OPEN_EXR_MULTILAYER"
settings.color_depth = depth
scene.render.use_file_extension = False
scene.render.filepath = out
bpy.ops.render.render(write_still=True)
