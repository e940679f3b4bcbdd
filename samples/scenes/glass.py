"""Glass and metal on a checkered table under one small lamp: caustics, reflections of reflections, and a wide-open lens
that blurs the features as well as the colour."""

import kit


def build():
    scene = kit.empty_scene()
    kit.plane((0, 0, 0), (14, 14), kit.checker("Table", (0.70, 0.66, 0.58), (0.07, 0.10, 0.14), 2.2, roughness=0.22))
    wall = kit.ramped(
        "Wall",
        "ShaderNodeTexNoise",
        {"Scale": 1.6, "Detail": 5.0},
        [(0.35, (0.20, 0.07, 0.05)), (0.65, (0.36, 0.15, 0.09))],
        roughness=0.8,
    )
    kit.box((-7, 4.5, -1), (7, 4.6, 5), wall)
    clear = kit.glass("Clear glass")
    kit.sphere((-0.55, 0.15, 0.55), 0.55, clear, 96)
    kit.sphere((0.62, -0.72, 0.30), 0.30, kit.glass("Amber glass", (1.0, 0.62, 0.22)), 96)
    kit.sphere((-1.35, -0.75, 0.24), 0.24, kit.glass("Green glass", (0.35, 0.95, 0.55)), 96)
    kit.sphere((0.85, 0.75, 0.62), 0.62, kit.plain("Copper", (0.95, 0.52, 0.34), 0.12, 1.0), 96)
    kit.sphere((-1.9, 1.7, 0.50), 0.50, kit.plain("Steel", (0.72, 0.74, 0.78), 0.28, 1.0), 96)
    kit.sphere((2.4, 2.3, 0.60), 0.60, kit.plain("Blue enamel", (0.02, 0.07, 0.45), 0.15), 96)
    kit.torus((-0.25, -1.05, 0.09), 0.26, 0.09, kit.plain("Gold", (1.0, 0.70, 0.22), 0.18, 1.0))
    kit.sphere((1.55, -0.25, 0.16), 0.16, kit.plain("Red enamel", (0.55, 0.03, 0.02), 0.2), 64)
    kit.lamp("AREA", 420, (2.4, 2.0, 4.2), (1.0, 0.88, 0.72), target=(0, 0, 0.2), shape="DISK", size=1.5)
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.35, 0.45, 0.65, 1)
    background.inputs["Strength"].default_value = 0.22
    kit.camera((-0.35, -4.4, 1.75), (0.0, 0.1, 0.36), 48, focus=(-0.45, -0.3, 0.5), fstop=0.6)
    scene.cycles.max_bounces = 12
    scene.cycles.caustics_reflective = True
    scene.cycles.caustics_refractive = True
    return scene
