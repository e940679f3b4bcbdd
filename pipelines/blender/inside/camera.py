"""A camera that samples only the pixels of a mask (Blender 5 and later; runs inside Blender).

Cycles' CUSTOM camera type takes an OSL shader that turns a place on the film into a ray. This shader makes the rays of
Blender's perspective or orthographic camera. Outside the mask the throughput is zero, for which Cycles traces nothing.

The place on the film includes a random offset by the pixel filter, so a sample of a pixel may fall outside of the
pixel, by `filter_overhang` at most. Therefore the mask has subpixels, and is open by that much around its pixels."""

import sys
import types

import bpy
from mathutils import Vector

TEXT_NAME = "polyrecon camera"

SHADER = """
shader camera(string mask = "", float left = 0, float bottom = 0, float width = 1, float height = 1,
              output point position = 0.0, output vector direction = 0.0, output color throughput = 1.0)
{
  point place = camera_shader_raster_position();  // 0..1 over the frame, y up
  float x = (place[0] - left) / width, y = (place[1] - bottom) / height;
  color inside = texture(mask, x, %(row)s, "interp", "closest", "wrap", "black", "width", 0);
  if (inside[0] < 0.5) {
    throughput = 0.0;
    return;
  }
  point plane = point(%(left)r + place[0] * %(width)r, %(bottom)r + place[1] * %(height)r, 0);
  point lens = 0;  // zero without depth of field
  getattribute("cam:aperture_position", lens);
  lens *= %(aperture_scale)r;
  float focus = 1;
  getattribute("cam:focal_distance", focus);
  if (%(orthographic)d) {
    direction = normalize(vector(0, 0, focus) - lens);
    // Cycles moves the ray forward by the near distance; its built-in camera moves it to the near plane.
    position = plane + lens + direction * (%(near)r / direction[2] - %(near)r);
  } else {
    vector straight = vector(plane[0], plane[1], 1);
    direction = normalize(straight * focus - lens);
    position = lens + direction * (%(near)r * (length(straight) - 1));
  }
}
"""


def why_not(scene, camera_object, depsgraph, device):
    """The reason why the mask camera would differ from the scene's camera; empty if it would not. device: see
    device.py."""
    camera = camera_object.data
    if bpy.app.version < (5, 0):
        return "Blender before 5.0 has no camera shaders"
    if camera.type not in ("PERSP", "ORTHO"):
        return f"the camera is of type {camera.type}"
    if device not in ("CPU", "OPTIX"):
        return f"Cycles has no camera shaders on {device}"
    if scene.render.use_motion_blur and camera.animation_data:
        return "the lens may change within the shutter"
    if scene.cycles.use_camera_cull or scene.cycles.use_distance_cull:
        return "objects are culled by the camera"
    if any(
        m.type == "SUBSURF" and getattr(m, "use_adaptive_subdivision", False)
        for o in scene.objects
        for m in o.modifiers
    ):
        return "adaptive subdivision dices by the camera"
    if _uses_window_coordinates():
        return "a material uses window coordinates"
    if _extends_beyond_clipping(camera_object, depsgraph):
        return "the far clipping plane cuts the scene"
    return ""


def _uses_window_coordinates():
    trees = [m.node_tree for m in bpy.data.materials] + [w.node_tree for w in bpy.data.worlds]
    trees += [light.node_tree for light in bpy.data.lights] + [g for g in bpy.data.node_groups if g.type == "SHADER"]
    return any(
        node.type == "TEX_COORD" and node.outputs["Window"].is_linked for tree in trees if tree for node in tree.nodes
    )


def _extends_beyond_clipping(camera_object, depsgraph):
    """Whether anything is further away than the far clipping distance: Blender's camera clips with a plane, the mask
    camera with a sphere."""
    camera = camera_object.matrix_world.translation
    limit = camera_object.data.clip_end
    for instance in depsgraph.object_instances:
        if instance.object.type in {"MESH", "CURVE", "CURVES", "SURFACE", "META", "FONT", "VOLUME", "POINTCLOUD"}:
            matrix = instance.matrix_world
            if any((matrix @ Vector(corner) - camera).length > limit for corner in instance.object.bound_box):
                return True
    return False


def filter_overhang(scene):
    """The distance in pixels by which a sample may fall outside of its pixel. Cycles' table for a filter of width w
    ends at w (Blackman-Harris) or 1.5 w (Gauss) from the pixel's centre."""
    ends = {"BOX": 0.5, "BLACKMAN_HARRIS": scene.cycles.filter_width, "GAUSSIAN": 1.5 * scene.cycles.filter_width}
    return max(0.0, ends[scene.cycles.pixel_filter_type] - 0.5)


class MaskCamera:
    """Switches the scene's camera between its type and the masked one, in memory only."""

    def __init__(self, scene):
        _provide_oslquery()
        self.camera = scene.camera.data
        self.scene_settings = {name: getattr(self.camera, name) for name in ("type", "shift_x", "shift_y")}
        text = bpy.data.texts.get(TEXT_NAME) or bpy.data.texts.new(TEXT_NAME)  # An earlier frame may have made it.
        text.clear()
        text.write(SHADER % self._values(scene))
        self.camera.custom_mode = "INTERNAL"
        self.camera.custom_shader = text
        self._compile()

    def _values(self, scene):
        camera = self.camera
        corners = camera.view_frame(scene=scene)  # includes shift, sensor fit and aspect; looks along -z
        orthographic = camera.type == "ORTHO"
        scale = 1.0 if orthographic else -1.0 / corners[0].z
        xs, ys = [c.x * scale for c in corners], [c.y * scale for c in corners]
        return {
            "left": min(xs),
            "bottom": min(ys),
            "width": max(xs) - min(xs),
            "height": max(ys) - min(ys),
            "aperture_scale": 1.0
            if orthographic
            else camera.lens * 1e-3,  # Cycles' unit for perspective cameras is the focal length.
            "orthographic": orthographic,
            "row": "y"
            if bpy.app.version >= (5, 2)
            else "1 - y",  # before 5.2 shaders count an image's rows from the top
            "near": camera.clip_start,
        }

    def _compile(self):
        from cycles import osl

        errors = []
        self.camera.type = "CUSTOM"
        compiled = osl.update_custom_camera_shader(self.camera, lambda kind, text: errors.append(text))
        self.camera.type = self.scene_settings["type"]
        if not compiled:
            raise RuntimeError(f"the camera shader does not compile: {errors}")

    def use(self, mask):
        """Selects a mask, or with None the scene's camera.

        mask: {path, left, bottom, width, height}: an image whose first channel is over 0.5 where samples are taken, and
        the part of the frame (0..1, from the bottom left) that it covers."""
        # The shader's rays include the shift; a shift of the camera would be added to them.
        for name, value in ({"type": "CUSTOM", "shift_x": 0, "shift_y": 0} if mask else self.scene_settings).items():
            setattr(self.camera, name, value)
        if mask:
            for name, value in mask.items():
                self.camera.cycles_custom["mask" if name == "path" else name] = value
            self.camera.update_tag()


def _provide_oslquery():
    """Defines the module oslquery, which Blender as a module lacks. Cycles lists a shader's parameters with it; the
    mask is set without that list, so it may be empty."""
    try:
        import oslquery  # noqa: F401
    except ImportError:
        module = types.ModuleType("oslquery")
        module.OSLQuery = lambda path: types.SimpleNamespace(parameters=())
        sys.modules["oslquery"] = module
