"""Ten frames in two shots: a room with light from its ceiling, a moving camera, a moving ball and a moving box, a small
lamp whose highlight moves over metal and floor, and a cut to another camera between frames 6 and 7."""

import math

import kit

FRAMES, CUT = 10, 7  # the second shot begins with frame 7


def build():
    scene = kit.empty_scene()
    scene.frame_start, scene.frame_end = 1, FRAMES
    scene.cycles.use_animated_seed = True
    _set()
    ball = kit.sphere((-0.9, 0.4, 0.45), 0.45, kit.plain("Metal", (0.75, 0.55, 0.3), 0.22, 1.0))
    _move(ball, (-0.9, 0.4, 0.45), (0.5, 0.1, 0.45))
    parcel = kit.box((-0.3, -0.3, 0), (0.3, 0.3, 0.6), kit.checker("Parcel", (0.5, 0.08, 0.05), (0.7, 0.6, 0.4), 8.0))
    _move(parcel, (1.3, 1.3, 0.3), (0.7, 0.9, 0.3), turn=50)
    kit.lamp("AREA", 160, (0, 0.6, 2.2), (1.0, 0.93, 0.82), target=(0, 0.6, 9), shape="DISK", size=0.8)
    lamp = kit.lamp("AREA", 6, (-1.5, -0.5, 2.0), (1.0, 0.72, 0.45), target=(0, 0.5, 0), shape="DISK", size=0.3)
    _move(lamp, (-1.5, -0.5, 2.0), (1.2, -0.2, 2.0))
    _cameras(scene)
    scene.cycles.max_bounces = 8
    scene.cycles.caustics_reflective = False
    return scene


def _set():
    kit.plane((0, 1, 0), (9, 9), kit.checker("Tiles", (0.3, 0.32, 0.34), (0.62, 0.58, 0.5), 2.5, roughness=0.25))
    paper = kit.ramped(
        "Wallpaper",
        "ShaderNodeTexVoronoi",
        {"Scale": 5.0},
        [(0.1, (0.18, 0.32, 0.42)), (0.5, (0.55, 0.6, 0.5))],
        roughness=0.8,
    )
    white = kit.plain("Plaster", (0.8, 0.78, 0.74), 0.9)
    kit.box((-3.2, 3.2, 0), (3.4, 3.4, 3.0), paper)
    kit.box((-3.2, -4.2, 0), (-3.0, 3.2, 3.0), paper)
    kit.box((3.2, -4.2, 0), (3.4, 3.2, 3.0), white)
    kit.box((-3.2, -4.4, 0), (3.4, -4.2, 3.0), white)
    kit.box((-3.2, -4.4, 3.0), (3.4, 3.4, 3.2), white)
    stone = kit.bumpy(kit.plain("Stone", (0.45, 0.4, 0.36), 0.9), 12, 0.6)
    for x in (-2.2, -0.2, 1.8):
        kit.cone((x, 2.4, 0), 0.22, 0.18, 2.2, stone)


def _move(obj, start, end, turn=0):
    """Moves an object along a line at constant speed, over all frames."""
    for frame, place, angle in ((1, start, 0), (FRAMES, end, turn)):
        obj.location = place
        obj.keyframe_insert("location", frame=frame)
        if turn:
            obj.rotation_euler[2] = math.radians(angle)
            obj.keyframe_insert("rotation_euler", frame=frame)
    for curve in _curves(obj.animation_data.action):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def _curves(action):
    """The curves of an action, of which Blender 5 has one set per layer, strip and slot."""
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    return [
        curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves
    ]


def _cameras(scene):
    first = kit.camera((-1.6, -3.6, 1.5), (-0.1, 1.0, 0.6), 32)
    _move(first, (-1.6, -3.6, 1.5), (-0.4, -3.2, 1.35))
    second = kit.camera((2.3, -2.4, 1.1), (0.1, 1.2, 0.5), 28)
    _move(second, (2.6, -2.4, 1.1), (1.8, -2.6, 1.2))
    scene.camera = first
    for name, frame, camera in (("first shot", 1, first), ("second shot", CUT, second)):
        scene.timeline_markers.new(name, frame=frame).camera = camera
