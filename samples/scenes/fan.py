"""A turning ventilator in the wall of a dusty workshop: the lamp behind it throws shafts of light into the air between
its blades, and both the blades and the shafts are blurred by their motion; a ball falls through them."""

import math

import bpy
import kit

HUB = (0.0, 4.0, 1.75)
RADIUS = 0.95


def build():
    scene = kit.empty_scene()
    _room()
    _ventilator()
    _bench()
    _ball()
    _dust()
    kit.lamp(
        "SPOT",
        12000,
        (1.6, 9.0, 4.6),
        (1.0, 0.90, 0.72),
        target=HUB,
        spot_size=0.5,
        spot_blend=0.2,
        shadow_soft_size=0.05,
    )
    kit.lamp("AREA", 22, (-2.4, -0.6, 2.7), (0.55, 0.70, 1.0), target=(0.3, 2.6, 0.8), shape="DISK", size=0.8)
    kit.sky((0.55, 0.66, 0.80), (0.25, 0.42, 0.75), 0.45)
    kit.camera((1.15, -1.9, 1.5), (-0.1, 4.0, 1.4), 28)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.5
    scene.cycles.max_bounces = 6
    scene.cycles.volume_bounces = 1
    scene.cycles.caustics_reflective = False
    scene.frame_set(1)
    return scene


def _room():
    brick = kit.ramped(
        "Bricks",
        "ShaderNodeTexNoise",
        {"Scale": 4.0, "Detail": 6.0},
        [(0.35, (0.16, 0.07, 0.05)), (0.65, (0.34, 0.17, 0.11))],
        roughness=0.85,
    )
    concrete = kit.ramped(
        "Concrete",
        "ShaderNodeTexNoise",
        {"Scale": 2.5, "Detail": 8.0},
        [(0.35, (0.14, 0.14, 0.13)), (0.65, (0.27, 0.26, 0.24))],
        roughness=0.4,
    )
    kit.plane((0, 1, 0), (6, 6.4), concrete)
    kit.box((-3.1, -2.2, 0), (-3, 4, 3.4), brick)
    kit.box((3, -2.2, 0), (3.1, 4, 3.4), brick)
    kit.box((-3, -2.3, 0), (3, -2.2, 3.4), brick)
    kit.box((-3, -2.2, 3.4), (3, 4, 3.5), concrete)
    x, _, z = HUB
    r = RADIUS + 0.05
    for low, high in (
        ((-3, 4, 0), (3, 4.2, z - r)),
        ((-3, 4, z + r), (3, 4.2, 3.4)),
        ((-3, 4, z - r), (x - r, 4.2, z + r)),
        ((x + r, 4, z - r), (3, 4.2, z + r)),
    ):
        kit.box(low, high, brick)


def _ventilator():
    """Five pitched blades on a hub, in a ring with a grille. They make a tenth of a turn per frame."""
    steel = kit.plain("Steel", (0.32, 0.33, 0.35), 0.35, 1.0)
    x, y, z = HUB
    kit.torus((x, y + 0.02, z), RADIUS, 0.04, steel, rotation=(90, 0, 0))
    for dx in (-0.5, 0.5):
        kit.box((x + dx - 0.012, y + 0.14, z - RADIUS), (x + dx + 0.012, y + 0.16, z + RADIUS), steel)
    vertices, faces, blades = [], [], 5
    for blade in range(blades):
        turn = 2 * math.pi * blade / blades
        first = len(vertices)
        for radius, half, pitch in ((0.10, 0.16, 0.07), (0.55, 0.30, 0.06), (0.88, 0.27, 0.045)):
            for side in (-1, 1):
                angle = turn + side * half * 0.36 / radius if radius > 0.2 else turn + side * 0.5
                vertices.append((radius * math.cos(angle), side * pitch, radius * math.sin(angle)))
        faces += [(first, first + 1, first + 3, first + 2), (first + 2, first + 3, first + 5, first + 4)]
    mesh = bpy.data.meshes.new("Blades")
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(kit.plain("Blade", (0.42, 0.40, 0.36), 0.4, 1.0))
    fan = bpy.data.objects.new("Blades", mesh)
    fan.location = HUB
    bpy.context.scene.collection.objects.link(fan)
    hub = kit.cone((x, y - 0.06, z - 0.08), 0.15, 0.15, 0.16, steel)
    hub.rotation_euler = (math.radians(90), 0, 0)
    for frame, turn in ((-10, -11 * 36.0), (12, 11 * 36.0)):
        fan.rotation_euler = (0, math.radians(turn + 10), 0)
        fan.keyframe_insert("rotation_euler", frame=frame)
    _even(fan)


def _bench():
    wood = kit.ramped(
        "Wood",
        "ShaderNodeTexNoise",
        {"Scale": 1.0, "Detail": 6.0},
        [(0.3, (0.13, 0.065, 0.03)), (0.7, (0.32, 0.18, 0.085))],
        roughness=0.5,
        scale=(1.0, 9.0, 1.0),
    )
    kit.box((-1.9, 1.9, 0.72), (-0.5, 2.6, 0.78), wood, bevel=0.01)
    for x in (-1.82, -0.58):
        for y in (1.98, 2.52):
            kit.box((x - 0.04, y - 0.04, 0), (x + 0.04, y + 0.04, 0.72), wood)
    kit.cone((-1.5, 2.25, 0.78), 0.10, 0.13, 0.24, kit.plain("Copper pot", (0.90, 0.48, 0.30), 0.2, 1.0))
    kit.box((-1.05, 2.1, 0.78), (-0.75, 2.4, 0.92), kit.plain("Tool box", (0.45, 0.05, 0.03), 0.3), turn=20, bevel=0.01)
    kit.cone((1.45, 2.9, 0), 0.32, 0.32, 0.85, kit.plain("Drum", (0.04, 0.17, 0.22), 0.35))
    kit.box(
        (0.55, 3.1, 0), (1.05, 3.6, 0.45), kit.checker("Crate", (0.36, 0.24, 0.12), (0.26, 0.16, 0.08), 5.0), turn=12
    )


def _ball():
    ball = kit.sphere((-0.62, 2.3, 1.2), 0.14, kit.checker("Ball", (0.80, 0.12, 0.04), (0.85, 0.80, 0.72), 9.0, 0.3))
    for frame, z in ((-1, 1.58), (3, 1.06)):
        ball.location.z = z
        ball.keyframe_insert("location", frame=frame)
    _even(ball)


def _dust():
    """Thin, even haze that fills the room."""
    made = bpy.data.materials.new("Dust")
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.remove(nodes["Principled BSDF"])
    scatter = nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Color"].default_value = (0.92, 0.92, 0.95, 1)
    scatter.inputs["Density"].default_value = 0.07
    scatter.inputs["Anisotropy"].default_value = 0.2
    links.new(scatter.outputs["Volume"], nodes["Material Output"].inputs["Volume"])
    kit.box((-2.99, -2.19, 0.001), (2.99, 3.999, 3.39), made)


def _even(obj):
    """Makes the motion between keyframes linear. Blender 5 keeps the curves in slots of layers."""
    action = obj.animation_data.action
    curves = getattr(action, "fcurves", None)
    if curves is None:
        curves = action.layers[0].strips[0].channelbags[0].fcurves
    for curve in curves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
