"""Renders a ball on a floor with Mitsuba 3: render_mitsuba.py OUT SEED PARTS...

PARTS are the integrators from the outer to the inner one: moment, aov, path. half: the film's default format; xyz,
luminance: the pixel format of the film, in place of rgb."""

import sys

import mitsuba as mi

out, seed, *parts = sys.argv[1:]
mi.set_variant("scalar_rgb")
integrator = {"type": "path"}
for part in reversed(parts):
    if part == "aov":
        integrator = {"type": "aov", "aovs": "albedo:albedo,nn:sh_normal,dd.y:depth,uv:uv", "img": integrator}
    if part == "moment":
        integrator = {"type": "moment", "img": integrator}
pixel_formats = [part for part in parts if part in ("xyz", "luminance")]
transform = mi.ScalarTransform4f
scene = {
    "type": "scene",
    "integrator": integrator,
    "sensor": {
        "type": "perspective",
        "fov": 40,
        "to_world": transform().look_at([0, 1, 5], [0, 0, 0], [0, 1, 0]),
        "film": {
            "type": "hdrfilm",
            "width": 32,
            "height": 24,
            "rfilter": {"type": "box"},
            "component_format": "float16" if "half" in parts else "float32",
            **({"pixel_format": pixel_formats[0]} if pixel_formats else {}),
        },
        "sampler": {"type": "independent", "sample_count": 16},
    },
    # The lamp is in the picture and brighter than half floats reach.
    "lamp": {
        "type": "sphere",
        "radius": 0.3,
        "center": [1, 0.9, 0],
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [1e5, 1e5, 9e4]}},
    },
    "ball": {
        "type": "sphere",
        "radius": 0.5,
        "center": [-0.5, -0.3, 0.3],
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.8, 0.3, 0.2]}},
    },
    "floor": {
        "type": "rectangle",
        "to_world": transform().translate([0, -1, 0]).rotate([1, 0, 0], -90).scale(3),
        "bsdf": {"type": "diffuse"},
    },
}
scene = mi.load_dict(scene)
mi.render(scene, seed=int(seed))
scene.sensors()[0].film().write(out)
