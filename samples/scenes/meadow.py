"""Grass and glossy, textured spheres in the sun under a blue sky, through a wide-open lens. Noise and blur are strong
in front of the focus and behind it, and hardly visible elsewhere."""

import math
import random

import bpy
import kit
from mathutils import Vector

BLADES = 700  # blades of a patch
PATCH = 1.0  # side of a patch in metres


def build():
    scene = kit.empty_scene()
    rng = random.Random(11)
    soil = kit.ramped(
        "Soil",
        "ShaderNodeTexNoise",
        {"Scale": 3.0, "Detail": 6.0},
        [(0.35, (0.035, 0.024, 0.014)), (0.65, (0.075, 0.060, 0.030))],
        roughness=0.95,
    )
    kit.plane((0, 15, 0), (60, 60), soil)
    _grass(rng)
    _spheres()
    kit.lamp("SUN", 6.0, (-5, -1.5, 4.5), (1.0, 0.90, 0.74), target=(0, 2, 0), angle=0.0093)
    kit.sky((0.70, 0.80, 0.92), (0.12, 0.30, 0.72), 0.8)
    kit.camera((0.0, -2.4, 0.72), (0.05, 2.0, 0.22), 50, focus=(0.1, 0.55, 0.3), fstop=0.45)
    scene.cycles.max_bounces = 8
    scene.cycles.transmission_bounces = 8
    return scene


def _grass(rng):
    """Copies of one patch of blades, in rows, with different turns and heights. They are sparse far away."""
    patches = [_patch(rng, colour) for colour in ((0.10, 0.22, 0.03), (0.16, 0.25, 0.05))]
    for row in range(14):
        y = -1.6 + row * PATCH * (0.8 if row < 8 else 1.3)
        columns = 3 + row
        for column in range(-columns // 2, columns // 2 + 1):
            obj = bpy.data.objects.new("Grass", rng.choice(patches))
            obj.location = (column * PATCH * 0.8 + rng.uniform(-0.1, 0.1), y + rng.uniform(-0.1, 0.1), 0)
            obj.rotation_euler = (0, 0, rng.uniform(0, 2 * math.pi))
            obj.scale = (1, 1, rng.uniform(0.7, 1.15))
            bpy.context.scene.collection.objects.link(obj)


def _patch(rng, colour):
    """A mesh of bent, tapering blades of three segments."""
    vertices, faces = [], []
    for _ in range(BLADES):
        root = Vector((rng.uniform(-0.5, 0.5) * PATCH, rng.uniform(-0.5, 0.5) * PATCH, 0))
        turn, lean = rng.uniform(0, 2 * math.pi), rng.uniform(0.15, 0.7)
        height, width = rng.uniform(0.09, 0.22), rng.uniform(0.003, 0.006)
        side = Vector((math.cos(turn), math.sin(turn), 0)) * width
        forward = Vector((-math.sin(turn), math.cos(turn), 0)) * height * lean
        first = len(vertices)
        for step in range(3):
            t = step / 3
            middle = root + forward * t * t + Vector((0, 0, height * t))
            vertices += [middle - side * (1 - t), middle + side * (1 - t)]
        vertices.append(root + forward + Vector((0, 0, height)))
        for step in range(2):
            a = first + 2 * step
            faces.append((a, a + 1, a + 3, a + 2))
        faces.append((first + 4, first + 5, first + 6))
    mesh = bpy.data.meshes.new("Blades")
    mesh.from_pydata([tuple(v) for v in vertices], [], faces)
    mesh.materials.append(_leaf(colour))
    return mesh


def _leaf(colour):
    """A glossy material that the sun shines through."""
    made, nodes, links, shader = kit.material("Leaf", colour, 0.4)
    through = nodes.new("ShaderNodeBsdfTranslucent")
    through.inputs["Color"].default_value = (colour[0] * 1.6, colour[1] * 1.6, colour[2], 1)
    mix = nodes.new("ShaderNodeMixShader")
    mix.inputs["Fac"].default_value = 0.35
    links.new(shader.outputs["BSDF"], mix.inputs[1])
    links.new(through.outputs["BSDF"], mix.inputs[2])
    links.new(mix.outputs["Shader"], nodes["Material Output"].inputs["Surface"])
    return made


def _spheres():
    marble = kit.ramped(
        "Marble",
        "ShaderNodeTexNoise",
        {"Scale": 3.5, "Detail": 7.0, "Distortion": 1.6},
        [(0.40, (0.75, 0.72, 0.68)), (0.52, (0.20, 0.18, 0.17)), (0.60, (0.70, 0.66, 0.60))],
        roughness=0.08,
    )
    kit.sphere((0.10, 0.75, 0.30), 0.30, marble, 96)
    kit.sphere((-0.62, 0.35, 0.17), 0.17, kit.checker("Ball", (0.75, 0.10, 0.05), (0.85, 0.80, 0.70), 9.0, 0.15))
    kit.sphere((0.72, 0.25, 0.13), 0.13, kit.plain("Chrome", (0.80, 0.80, 0.82), 0.03, 1.0))
    kit.sphere((-0.95, 2.6, 0.42), 0.42, kit.plain("Brass", (0.90, 0.66, 0.28), 0.22, 1.0))
    kit.sphere((1.35, 3.4, 0.50), 0.50, kit.plain("Lacquer", (0.03, 0.10, 0.40), 0.1))
    kit.sphere((0.35, 6.0, 0.60), 0.60, kit.checker("Beach ball", (0.85, 0.60, 0.08), (0.05, 0.30, 0.45), 3.0, 0.25))
    kit.sphere((-0.24, -0.95, 0.10), 0.10, kit.plain("Cherry", (0.50, 0.02, 0.03), 0.12))
