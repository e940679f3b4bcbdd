"""A small study: daylight falls through a window the camera does not see, a desk lamp adds warm light; most of
the picture is lit indirectly and mirrored in a polished floor. The two lights are light groups."""

import random

import kit


def build():
    scene = kit.empty_scene()
    rng = random.Random(4)
    _room()
    _bookcase(rng)
    bulb = _desk()
    _carpet_and_chair()
    sun = kit.lamp("SUN", 16.0, (-6, 2.2, 5), (1.0, 0.86, 0.68), target=(0.2, 2.5, 0.4), angle=0.02)
    kit.sky((0.62, 0.72, 0.85), (0.30, 0.48, 0.85), 9.0)
    for y in (1.1, 2.6):  # shows Cycles where the sky is visible
        portal = kit.lamp("AREA", 0, (-2.1, y, 1.55), target=(0, y, 1.55), shape="RECTANGLE", size=1.5, size_y=1.0)
        portal.data.cycles.is_portal = True
    kit.light_groups({"daylight": [sun, scene.world], "lamp": [bulb]})
    kit.camera((1.15, -1.75, 1.4), (-0.05, 3.2, 0.98), 23)
    scene.cycles.max_bounces = 8
    scene.cycles.diffuse_bounces = 6
    scene.cycles.glossy_bounces = 4
    scene.cycles.caustics_reflective = False  # the sun in the floor would speckle even the reference
    return scene


def _room():
    """4 m x 6 m x 2.7 m; the left wall has two window openings."""
    wood = kit.ramped(
        "Planks",
        "ShaderNodeTexNoise",
        {"Scale": 1.0, "Detail": 6.0},
        [(0.3, (0.12, 0.055, 0.025)), (0.7, (0.34, 0.17, 0.075))],
        roughness=0.12,
        scale=(9, 0.7, 1),
    )
    paper = kit.ramped(
        "Wallpaper",
        "ShaderNodeTexVoronoi",
        {"Scale": 7.0},
        [(0.1, (0.30, 0.42, 0.40)), (0.5, (0.52, 0.60, 0.52))],
        roughness=0.8,
    )
    white = kit.plain("Plaster", (0.78, 0.76, 0.72), 0.9)
    kit.plane((0, 1, 0), (4, 6), wood)
    kit.box((-2, -2, 2.7), (2, 4, 2.8), white)
    kit.box((-2, 4, 0), (2, 4.1, 2.7), paper)
    kit.box((-2, -2.1, 0), (2, -2, 2.7), white)
    kit.box((2, -2, 0), (2.1, 4, 2.7), paper)
    for low, high in (
        ((-2.2, -2, 0), (-2, 4, 0.8)),
        ((-2.2, -2, 2.3), (-2, 4, 2.7)),
        ((-2.2, -2, 0.8), (-2, 0.6, 2.3)),
        ((-2.2, 1.6, 0.8), (-2, 2.1, 2.3)),
        ((-2.2, 3.1, 0.8), (-2, 4, 2.3)),
    ):
        kit.box(low, high, white)
    for y in (1.1, 2.6):
        kit.box((-2.12, y - 0.02, 0.8), (-2.08, y + 0.02, 2.3), white)
        kit.box((-2.12, y - 0.5, 1.53), (-2.08, y + 0.5, 1.57), white)
    for low, high in (((-2, 3.97, 0), (2, 4, 0.1)), ((1.97, -2, 0), (2, 4, 0.1)), ((-2, -2, 0), (-1.97, 4, 0.1))):
        kit.box(low, high, white)


def _bookcase(rng):
    frame = kit.plain("Oak", (0.22, 0.12, 0.06), 0.35)
    covers = [
        kit.plain(f"Cover {i}", colour, rng.uniform(0.3, 0.7))
        for i, colour in enumerate(
            (
                (0.45, 0.05, 0.04),
                (0.05, 0.12, 0.30),
                (0.06, 0.22, 0.10),
                (0.55, 0.38, 0.10),
                (0.60, 0.55, 0.45),
                (0.10, 0.08, 0.08),
                (0.32, 0.14, 0.30),
            )
        )
    ]
    left, right, back, front = -1.75, -0.25, 3.97, 3.67
    for x in (left, right):
        kit.box((x - 0.02, front, 0), (x + 0.02, back, 2.1), frame)
    for row in range(6):
        z = 0.06 + row * 0.4
        kit.box((left, front, z - 0.015), (right, back, z + 0.015), frame)
        if row == 5:
            break
        x = left + 0.03
        while x < right - 0.1:
            thick, tall = rng.uniform(0.025, 0.06), rng.uniform(0.22, 0.34)
            if rng.random() < 0.88:
                kit.box((x, front + 0.03, z + 0.015), (x + thick, back - 0.03, z + tall), rng.choice(covers))
            x += thick + 0.003
    kit.sphere((-1.35, 3.8, 2.25), 0.13, kit.plain("Brass globe", (0.85, 0.62, 0.25), 0.25, 1.0))


def _desk():
    """A desk with a lamp under an opaque shade, a vase and a framed picture; returns the bulb."""
    wood = kit.plain("Walnut", (0.16, 0.08, 0.045), 0.25)
    brass = kit.plain("Brass", (0.85, 0.62, 0.25), 0.2, 1.0)
    kit.box((0.35, 3.15, 0.72), (1.85, 3.9, 0.76), wood, bevel=0.008)
    for x in (0.42, 1.78):
        for y in (3.22, 3.83):
            kit.box((x - 0.03, y - 0.03, 0), (x + 0.03, y + 0.03, 0.72), wood)
    kit.cone((1.5, 3.6, 0.76), 0.09, 0.07, 0.02, brass)
    kit.cone((1.5, 3.6, 0.78), 0.012, 0.012, 0.36, brass)
    kit.cone((1.5, 3.6, 1.05), 0.17, 0.10, 0.2, kit.plain("Shade", (0.65, 0.55, 0.35), 0.8), caps=False)
    bulb = kit.lamp("POINT", 45.0, (1.5, 3.6, 1.14), (1.0, 0.62, 0.28), shadow_soft_size=0.045)
    kit.sphere((0.75, 3.5, 0.88), 0.12, kit.plain("Glaze", (0.03, 0.14, 0.28), 0.08))
    kit.cone((0.75, 3.5, 0.97), 0.04, 0.06, 0.12, kit.plain("Glaze neck", (0.03, 0.14, 0.28), 0.08))
    kit.box((1.0, 3.3, 0.76), (1.25, 3.48, 0.79), kit.plain("Red book", (0.45, 0.05, 0.04)), turn=15)
    kit.box((1.01, 3.31, 0.79), (1.22, 3.47, 0.815), kit.plain("Cream book", (0.6, 0.52, 0.4)), turn=-8)
    kit.box((0.55, 3.96, 1.35), (1.35, 4.0, 1.95), kit.plain("Frame", (0.55, 0.38, 0.12), 0.3, 1.0))
    kit.box(
        (0.61, 3.95, 1.41),
        (1.29, 3.97, 1.89),
        kit.ramped(
            "Painting",
            "ShaderNodeTexNoise",
            {"Scale": 2.5, "Detail": 3.0, "Distortion": 1.2},
            [(0.3, (0.06, 0.16, 0.35)), (0.5, (0.75, 0.62, 0.35)), (0.65, (0.55, 0.12, 0.05))],
            roughness=0.6,
        ),
    )
    return bulb


def _carpet_and_chair():
    rug = kit.checker("Rug", (0.36, 0.06, 0.05), (0.62, 0.50, 0.33), 5.0, roughness=1.0)
    kit.box((-1.1, 1.0, 0), (0.7, 2.6, 0.012), rug)
    cloth = kit.bumpy(kit.plain("Cloth", (0.10, 0.22, 0.20), 0.9), 60, 0.3)
    leg = kit.plain("Leg", (0.08, 0.04, 0.02), 0.3)
    kit.box((-1.5, 1.9, 0.22), (-0.75, 2.6, 0.45), cloth, turn=-25, bevel=0.06)
    back = kit.box((-1.62, 2.35, 0.30), (-0.87, 2.53, 0.95), cloth, turn=-25, bevel=0.06)
    back.location.x += 0.25
    back.location.y += 0.10
    for x, y in ((-1.35, 1.95), (-0.72, 2.2), (-1.0, 2.6), (-1.5, 2.35)):
        kit.cone((x, y, 0), 0.02, 0.03, 0.24, leg)
