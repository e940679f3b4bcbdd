"""A lighthouse by day: the upper half is empty sky, the sea mirrors it in small waves, the sun casts soft shadows."""

from math import cos, pi, sin

import bpy
import kit


def build():
    scene = kit.empty_scene()
    sea = kit.plain("Sea", (0.012, 0.05, 0.07), 0.06)
    kit.bumpy(sea, 1.4, 0.5, 0.25, stretch=(1, 2.2, 1), detail=6.0)
    kit.plane((0, 380, 0), (1600, 800), sea)
    stone = kit.ramped(
        "Stone",
        "ShaderNodeTexNoise",
        {"Scale": 2.2, "Detail": 8.0},
        [(0.35, (0.09, 0.08, 0.07)), (0.65, (0.34, 0.31, 0.27))],
        roughness=0.85,
    )
    grass = kit.ramped(
        "Grass",
        "ShaderNodeTexNoise",
        {"Scale": 3.0, "Detail": 8.0},
        [(0.35, (0.05, 0.10, 0.02)), (0.65, (0.16, 0.20, 0.05))],
        roughness=0.9,
    )
    kit.rock((4.5, 24, -0.8), (9.0, 6.5, 2.6), stone, 1)
    kit.rock((4.8, 24.5, 0.4), (6.0, 4.2, 1.75), grass, 2, rough=0.2)
    for i, (x, y, s) in enumerate(
        ((-4.8, 19, 1.3), (-8.2, 24, 1.7), (-2.3, 15.5, 0.7), (12.5, 17, 1.4), (1.6, 15.8, 0.8))
    ):
        kit.rock((x, y, 0), (s, s * 0.9, s * 0.75), stone, 3 + i)
    _tower(6.0, 24.5, 1.7)
    _house(2.4, 24.0, 1.5)
    kit.lamp("SUN", 5.0, (-9, 4, 9), (1.0, 0.88, 0.70), target=(4, 24, 0), angle=0.03)
    kit.sky((0.80, 0.84, 0.86), (0.13, 0.31, 0.68), 0.9)
    kit.camera((0, 0, 3.4), (1.6, 24, 5.2), 31)
    scene.cycles.max_bounces = 6
    scene.cycles.caustics_reflective = False  # the sun in the waves would speckle even the reference
    return scene


def _tower(x, y, z):
    white, red = kit.plain("White paint", (0.80, 0.79, 0.75), 0.6), kit.plain("Red paint", (0.55, 0.045, 0.03), 0.5)
    dark = kit.plain("Iron", (0.05, 0.05, 0.06), 0.4, 1.0)
    bands, height, bottom, top = 6, 1.25, 1.15, 0.72
    for i in range(bands):
        wide, narrow = (bottom + (top - bottom) * k / bands for k in (i, i + 1))
        kit.cone((x, y, z + i * height), wide, narrow, height, red if i % 2 else white)
    z += bands * height
    kit.cone((x, y, z), 1.0, 1.0, 0.12, dark)
    for i in range(12):
        kit.cone((x + 0.95 * cos(i * pi / 6), y + 0.95 * sin(i * pi / 6), z + 0.12), 0.02, 0.02, 0.4, dark)
    kit.torus((x, y, z + 0.52), 0.95, 0.025, dark)
    kit.cone((x, y, z + 0.12), 0.5, 0.5, 0.9, kit.plain("Pane", (0.75, 0.72, 0.55), 0.1))
    kit.cone((x, y, z + 1.02), 0.62, 0.05, 0.55, red)


def _house(x, y, z):
    wall, roof = kit.plain("House", (0.76, 0.73, 0.66), 0.8), kit.plain("Tiles", (0.34, 0.10, 0.05), 0.7)
    kit.box((x - 1.3, y - 0.8, z - 1.0), (x + 1.3, y + 0.8, z + 1.1), wall)
    vertices = [(-1.5, -1.0, 1.1), (1.5, -1.0, 1.1), (1.5, 1.0, 1.1), (-1.5, 1.0, 1.1), (-1.5, 0, 2.0), (1.5, 0, 2.0)]
    mesh = bpy.data.meshes.new("Roof")
    mesh.from_pydata(
        [(x + a, y + b, z + c) for a, b, c in vertices],
        [],
        [(0, 1, 5, 4), (2, 3, 4, 5), (1, 2, 5), (3, 0, 4), (0, 3, 2, 1)],
    )
    mesh.materials.append(roof)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Roof", mesh))
    window = kit.plain("Window", (0.03, 0.04, 0.05), 0.1)
    for dx in (-0.75, 0.0, 0.75):
        kit.box((x + dx - 0.17, y - 0.82, z + 0.25), (x + dx + 0.17, y - 0.8, z + 0.75), window)
