"""Runs inside Blender and builds a small .blend file: make_scene.py OUT.blend KIND."""

import os
import sys

import bpy

HOSTILE = "import pathlib; pathlib.Path({mark!r}).touch()"


def use_nodes(block):
    if bpy.app.version < (5, 0):  # Blender 5 always uses nodes.
        block.use_nodes = True


def base():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 48, 32, 100
    scene.world = bpy.data.worlds.new("World")
    use_nodes(scene.world)
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.3, 0.4, 0.6, 1)
    bpy.ops.mesh.primitive_plane_add(size=20)
    for i, x in enumerate((-1.6, 0, 1.7)):
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.7, location=(x, i * 1.5, 0.7))
        material = bpy.data.materials.new(f"M{i}")
        use_nodes(material)
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.8, 0.3 * i, 0.2, 1)
        bpy.context.object.data.materials.append(material)
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
    lamp.data.energy, lamp.location = 200, (2, -2, 4)
    scene.collection.objects.link(lamp)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.5, -6, 1.6), (1.45, 0, 0.06)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def lens(scene):
    """All features of a perspective camera: shift, fit, pixel aspect, a wide polygonal aperture."""
    camera = scene.camera.data
    camera.lens, camera.shift_x, camera.shift_y = 40, 0.08, -0.05
    camera.sensor_fit, camera.sensor_width, camera.sensor_height = "VERTICAL", 36, 20
    camera.clip_start = 0.5
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = 1.0, 1.3
    depth_of_field(scene)


def depth_of_field(scene):
    dof = scene.camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 6.5, 0.2
    dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio = 5, 0.4, 1.6


def orthographic(scene):
    scene.camera.data.type, scene.camera.data.ortho_scale, scene.camera.data.shift_x = "ORTHO", 5, 0.05
    depth_of_field(scene)
    scene.camera.data.dof.aperture_fstop = 1.5


def caustic(scene):
    """Uneven, skewed noise: glass over a floor, a small lamp. A tiny frame."""
    scene.render.resolution_x, scene.render.resolution_y = 24, 16
    glass = bpy.data.materials["M1"].node_tree.nodes["Principled BSDF"]
    glass.inputs["Roughness"].default_value = 0.05
    glass.inputs["Transmission Weight" if "Transmission Weight" in glass.inputs else "Transmission"].default_value = 1
    bpy.data.objects["Lamp"].data.size = 0.2
    scene.world.node_tree.nodes["Background"].inputs[1].default_value = 0.1
    scene.cycles.sample_clamp_indirect = 0


def panoramic(scene):
    scene.camera.data.type = "PANO"


def still_motion_blur(scene):
    scene.render.use_motion_blur = True


def moving(scene):
    scene.render.use_motion_blur = True
    sphere = bpy.data.objects["Sphere"]
    for frame, x in ((1, -2), (3, 2)):
        sphere.location.x = x
        sphere.keyframe_insert("location", frame=frame)
    scene.frame_set(2)


def shot(scene):
    """Four frames with a moving camera. In the third a small lamp behind glass lights the scene in place of the sky,
    which makes that frame far noisier."""
    caustic(scene)
    scene.render.resolution_x, scene.render.resolution_y = 48, 28
    camera, lamp, glass = bpy.data.objects["Camera"], bpy.data.lights["Lamp"], bpy.data.objects["Sphere.001"]
    lamp.size = 0.1
    sky = scene.world.node_tree.nodes["Background"].inputs[1]
    for frame in range(1, 5):
        camera.location.x = 0.3 + 0.1 * frame
        camera.keyframe_insert("location", frame=frame)
        lamp.energy, sky.default_value, glass.hide_render = (3000, 0.003, False) if frame == 3 else (0, 1, True)
        lamp.keyframe_insert("energy", frame=frame)
        sky.keyframe_insert("default_value", frame=frame)
        glass.keyframe_insert("hide_render", frame=frame)
    scene.frame_set(1)


def seed_animated(scene):
    for frame in (1, 2):
        scene.cycles.seed = 40 + frame
        scene.keyframe_insert("cycles.seed", frame=frame)
    scene.frame_set(1)


def on_a_card(scene):
    scene.cycles.device = "GPU"


def switched_on(scene):
    """Everything that the audit switches off."""
    scene.render.use_motion_blur = True
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.render.use_compositing = scene.render.use_sequencer = True
    scene.render.use_border, scene.render.border_max_x = True, 0.5


def hostile(scene):
    """A file that tries to run code in every way of a .blend file; each would leave a file next to this one."""
    folder = os.path.dirname(os.path.abspath(sys.argv[-2]))
    scene.cycles.samples, scene.cycles.use_denoising = 1, False  # Freestyle draws no lines after a failed render.

    def code(name):
        return HOSTILE.format(mark=os.path.join(folder, f"ran_{name}"))

    text = bpy.data.texts.new("start.py")
    text.write(code("text"))
    text.use_module = True
    handler = bpy.data.texts.new("handlers.py")
    events = "load_post render_init render_pre frame_change_post depsgraph_update_post render_complete"
    handler.write(
        f"import bpy\ndef run(*_): {code('handler')}\n"
        f"for event in {events.split()!r}: getattr(bpy.app.handlers, event).append(run)\n"
    )
    handler.use_module = True
    drawing = bpy.data.texts.new("lines.py")
    drawing.write(code("freestyle"))
    scene.render.use_freestyle = True
    settings = scene.view_layers[0].freestyle_settings
    settings.mode = "SCRIPT"
    settings.modules.new().script = drawing
    driver = bpy.data.objects["Sphere"].driver_add("location", 0).driver
    driver.type = "SCRIPTED"
    driver.expression = f"(exec({code('driver')!r}), 0)[1]"


def linking(scene):
    """Links a lamp and its texture, an image, the frames of a sequence, tiles, and a file that is missing."""
    folder = os.path.dirname(os.path.abspath(sys.argv[-2]))
    lamp = bpy.data.lights["Lamp"]
    lamp.use_nodes = True
    texture(lamp.node_tree, write_image(os.path.join(folder, "lamp.png"), 0.5))
    bpy.data.libraries.write(
        os.path.join(folder, "library.blend"), {bpy.data.objects["Lamp"]}, path_remap="RELATIVE_ALL"
    )
    bpy.data.objects.remove(bpy.data.objects["Lamp"])
    with bpy.data.libraries.load(os.path.join(folder, "library.blend"), link=True) as (_, linked):
        linked.objects = ["Lamp"]
    scene.collection.objects.link(linked.objects[0])
    trees = [material.node_tree for material in bpy.data.materials[:3]]
    texture(trees[0], write_image(os.path.join(folder, "floor.png"), 0.2))
    for name in ("frame_1.png", "frame_2.png", "tile.1001.png", "tile.1002.png", "unused.png"):
        write_image(os.path.join(folder, name), 0.7)
    texture(trees[1], bpy.data.images.load(os.path.join(folder, "frame_1.png"))).source = "SEQUENCE"
    tiles = texture(trees[2], bpy.data.images.load(os.path.join(folder, "tile.1001.png")))
    tiles.source = "TILED"
    tiles.filepath = os.path.join(folder, "tile.<UDIM>.png")
    gone = bpy.data.images.new("gone", 1, 1)
    gone.source, gone.filepath, gone.use_fake_user = "FILE", os.path.join(folder, "gone.png"), True
    script = trees[0].nodes.new("ShaderNodeScript")
    script.mode, script.filepath = "EXTERNAL", os.path.join(folder, "script.osl")
    with open(script.filepath, "w") as file:
        file.write("shader nothing() {}")


def caching(scene):
    """Reads the cache of an ocean from one folder, and that of points from another."""
    folder = os.path.dirname(os.path.abspath(sys.argv[-2]))
    object_ = next(one for one in scene.objects if one.type == "MESH")
    for name, file in (("ocean", "disp_0001.exr"), ("points", "cloth_000001_00.bphys")):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
        with open(os.path.join(folder, name, file), "wb") as cache:
            cache.write(b"cached")
    object_.modifiers.new("ocean", "OCEAN").filepath = os.path.join(folder, "ocean")
    points = object_.modifiers.new("cloth", "CLOTH").point_cache
    points.use_external, points.filepath = True, os.path.join(folder, "points", "")


def write_image(path, value):
    image = bpy.data.images.new("made", 2, 2)
    image.pixels = [value, value, value, 1] * 4
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    return bpy.data.images.load(path)


def texture(tree, image):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    return image


def forging(scene):
    """A library whose path holds lines like the session's answers. It is gone, so Blender prints its path."""
    folder = os.path.dirname(os.path.abspath(sys.argv[-2]))
    for number, text in enumerate(('@polyrecon {"error": "forged"}', "@polyrecon garbage", "@polyrecon [1]")):
        path = os.path.join(folder, f"lib{number}\n{text}\n.blend")
        item = bpy.data.meshes.new(f"item{number}")
        bpy.data.libraries.write(path, {item})
        with bpy.data.libraries.load(path, link=True) as (_, linked):
            linked.meshes = [item.name]
        os.unlink(path)
        scene.collection.objects.link(bpy.data.objects.new(f"item{number}", linked.meshes[0]))


def escapes(scene):
    """Names that hold control characters; the driver prints both."""
    scene.view_layers[0].name = "a\x1b]0;title\x07\nopenjd_fail: b"
    scene.view_layers.new("c\x1b[2J\nopenjd_env: D=E")


def simulating(scene):
    """Simulations that are cached on disk while frames are evaluated: next to the file, and where it says."""
    folder = os.path.dirname(os.path.abspath(sys.argv[-2]))
    bpy.ops.mesh.primitive_grid_add(size=2, x_subdivisions=8, y_subdivisions=8, location=(0, -2, 1.5))
    cloth = bpy.context.object.modifiers.new("cloth", "CLOTH")
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(sys.argv[-2]))
    cloth.point_cache.use_disk_cache = True  # of a file that has a name
    if not bpy.app.binary_path:
        return  # The module's fluid simulation ends Python.
    bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 0, 1))
    domain = bpy.context.object.modifiers.new("fluid", "FLUID")
    domain.fluid_type = "DOMAIN"
    settings = domain.domain_settings
    settings.resolution_max, settings.cache_type = 8, "REPLAY"
    settings.cache_directory = os.path.join(folder, "elsewhere")


def user_passes(scene):
    """Passes for compositing, the samples that they may have, and how the picture is to be written."""
    scene.cycles.samples = 64
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.use_pass_object_index = layer.use_pass_diffuse_color = True
    layer.use_pass_cryptomatte_object = True
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "16", "PIZ"


def view_layers(scene):
    """Two view layers over nothing; the second has another material."""
    scene.render.film_transparent = True
    scene.view_layers[0].name = "near"
    layer = scene.view_layers.new("far")
    layer.material_override = bpy.data.materials.new("grey")
    if hasattr(scene.cycles, "use_guiding"):
        scene.cycles.use_guiding = True


def compressed(scene):
    """Saved with compression."""
    bpy.context.preferences.filepaths.use_file_compression = True


MADE = (
    user_passes,
    view_layers,
    compressed,
    lens,
    depth_of_field,
    caustic,
    orthographic,
    panoramic,
    still_motion_blur,
    moving,
    shot,
    seed_animated,
    on_a_card,
    switched_on,
    hostile,
    linking,
    caching,
    forging,
    escapes,
    simulating,
)
KINDS = {f.__name__: f for f in MADE}


def main():
    out, kind = sys.argv[-2:]
    scene = base()
    if kind != "plain":
        KINDS[kind](scene)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(out), check_existing=False)


main()
