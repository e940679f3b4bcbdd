"""A hall whose lamps are behind baffles: the camera sees none of them and no light falls on the floor directly. So the
light of every pixel has bounced at least once, and the noise has spikes."""

import kit

LENGTH, WIDTH, HEIGHT = 9.0, 4.4, 3.0


def build():
    scene = kit.empty_scene()
    _hall()
    _exhibits()
    for x in (-WIDTH / 2 + 0.12, WIDTH / 2 - 0.12):
        warm = (1.0, 0.74, 0.46) if x < 0 else (0.70, 0.84, 1.0)
        for y in (1.6, 4.2, 6.8):
            # In a trough open towards the ceiling; the trough's lip hides it from below.
            kit.lamp("POINT", 26.0, (x, y, 2.36), warm, shadow_soft_size=0.03)
    # Behind the last wall: its light comes round the corner.
    kit.lamp("POINT", 90.0, (1.5, LENGTH + 0.7, 1.2), (1.0, 0.55, 0.25), shadow_soft_size=0.05)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0
    kit.camera((0.35, -0.75, 1.5), (-0.15, 5.0, 1.05), 24)
    scene.cycles.max_bounces = 10
    scene.cycles.diffuse_bounces = 8
    scene.cycles.caustics_reflective = False  # point lamps in polished stone would speckle even the reference
    scene.cycles.caustics_refractive = False
    return scene


def _hall():
    stone = kit.ramped(
        "Terrazzo",
        "ShaderNodeTexVoronoi",
        {"Scale": 9.0},
        [(0.1, (0.42, 0.38, 0.33)), (0.6, (0.20, 0.19, 0.19))],
        roughness=0.15,
    )
    plaster = kit.plain("Plaster", (0.74, 0.72, 0.68), 0.9)
    red = kit.plain("Red wall", (0.50, 0.09, 0.06), 0.8)
    half, far = WIDTH / 2, LENGTH + 1.6
    kit.plane((0, far / 2 - 0.75, 0), (WIDTH, far + 1.5), stone)
    kit.box((-half, -1.5, HEIGHT), (half, far, HEIGHT + 0.1), plaster)
    kit.box((-half - 0.1, -1.5, 0), (-half, far, HEIGHT), plaster)
    kit.box((half, -1.5, 0), (half + 0.1, far, HEIGHT), red)
    kit.box((-half, -1.6, 0), (half, -1.5, HEIGHT), plaster)
    kit.box((-half, far, 0), (half, far + 0.1, HEIGHT), plaster)
    kit.box((-half, LENGTH - 0.05, 0), (0.35, LENGTH + 0.05, HEIGHT), plaster)  # the last wall, with a gap at its right
    white = kit.plain("Trough", (0.80, 0.79, 0.76), 0.7)
    for side in (-1, 1):
        x = side * half
        low, high = sorted((x, x - side * 0.30))
        kit.box((low, -1.5, 2.22), (high, LENGTH, 2.26), white)
        low, high = sorted((x - side * 0.27, x - side * 0.30))
        kit.box((low, -1.5, 2.26), (high, LENGTH, 2.50), white)
    for y in (2.9, 5.5, 8.0):
        for x in (-half + 0.45, half - 0.45):
            kit.cone((x, y, 0), 0.15, 0.12, HEIGHT, plaster)


def _exhibits():
    wood = kit.plain("Plinth", (0.05, 0.045, 0.04), 0.3)
    for x, y in ((-0.75, 2.6), (0.7, 3.3), (-0.5, 5.4), (0.55, 6.9)):
        kit.box((x - 0.2, y - 0.2, 0), (x + 0.2, y + 0.2, 0.75), wood, bevel=0.01)
    kit.sphere((-0.75, 2.6, 0.98), 0.23, kit.plain("Gold", (1.0, 0.70, 0.28), 0.18, 1.0), 96)
    kit.sphere((0.7, 3.3, 0.97), 0.22, kit.plain("Porcelain", (0.08, 0.18, 0.42), 0.06), 96)
    kit.torus((-0.5, 5.4, 1.02), 0.2, 0.08, kit.plain("Bronze", (0.55, 0.33, 0.16), 0.3, 1.0), rotation=(80, 0, 30))
    kit.rock((0.55, 6.9, 0.98), (0.2, 0.2, 0.25), kit.plain("Marble", (0.72, 0.70, 0.66), 0.35), 5)
    kit.box((-0.5, 4.4, 0), (0.5, 4.9, 0.42), kit.plain("Bench", (0.30, 0.15, 0.07), 0.4), bevel=0.02)
    for i, y in enumerate((1.75, 4.2, 6.75)):
        for x in (-WIDTH / 2, WIDTH / 2):
            low, high = sorted((x, x * 0.985))
            kit.box((low, y - 0.5, 0.95), (high, y + 0.5, 1.75), kit.plain("Frame", (0.25, 0.15, 0.06), 0.35))
            low, high = sorted((x, x * 0.982))
            kit.box((low, y - 0.44, 1.01), (high, y + 0.44, 1.69), _painting(i if x < 0 else i + 3))


def _painting(number):
    pigments = [(0.05, 0.14, 0.34), (0.70, 0.58, 0.30), (0.50, 0.10, 0.05), (0.10, 0.30, 0.18), (0.75, 0.72, 0.65)]
    chosen = [pigments[(number * 2 + k) % 5] for k in (0, 1, 3)]
    return kit.ramped(
        f"Painting {number}",
        "ShaderNodeTexNoise",
        {"Scale": 2.0 + number * 0.4, "Detail": 4.0, "Distortion": 1.5},
        list(zip((0.32, 0.5, 0.66), chosen)),
        roughness=0.6,
        scale=(1, 1 + 0.2 * number, 1),
    )
