"""Building blocks of the sample scenes, for Blender 3.4 to 5.0."""

import math

import bpy
from mathutils import Vector


def empty_scene():
    """An empty scene for Cycles, without clamping, so that samples are unbiased."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.sample_clamp_direct = 0
    scene.cycles.sample_clamp_indirect = 0
    scene.cycles.blur_glossy = 0
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    return scene


def material(name, colour=(0.8, 0.8, 0.8), roughness=0.5, metallic=0.0):
    """A Principled material; returns (material, its nodes, its links, the shader)."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    shader = nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = metallic
    return made, nodes, links, shader


def plain(name, colour, roughness=0.5, metallic=0.0):
    return material(name, colour, roughness, metallic)[0]


def ramped(name, texture, settings, stops, roughness=0.5, coordinates="Object", scale=(1, 1, 1)):
    """A material whose colour is a texture node through a colour ramp with stops (position, rgb)."""
    made, nodes, links, shader = material(name, roughness=roughness)
    place = nodes.new("ShaderNodeTexCoord")
    mapping = nodes.new("ShaderNodeMapping")
    mapping.inputs["Scale"].default_value = scale
    image = nodes.new(texture)
    for key, value in settings.items():
        image.inputs[key].default_value = value
    ramp = nodes.new("ShaderNodeValToRGB")
    elements = ramp.color_ramp.elements
    while len(elements) < len(stops):
        elements.new(1.0)
    for element, (position, colour) in zip(elements, stops):
        element.position = position
        element.color = (*colour, 1)
    links.new(place.outputs[coordinates], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], image.inputs["Vector"])
    links.new(image.outputs[0], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], shader.inputs["Base Color"])
    return made


def checker(name, colour_a, colour_b, scale, roughness=0.4):
    made, nodes, links, shader = material(name, roughness=roughness)
    place = nodes.new("ShaderNodeTexCoord")
    image = nodes.new("ShaderNodeTexChecker")
    image.inputs["Color1"].default_value = (*colour_a, 1)
    image.inputs["Color2"].default_value = (*colour_b, 1)
    image.inputs["Scale"].default_value = scale
    links.new(place.outputs["Object"], image.inputs["Vector"])
    links.new(image.outputs["Color"], shader.inputs["Base Color"])
    return made


def glass(name, colour=(1, 1, 1), roughness=0.0, ior=1.45):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.remove(nodes["Principled BSDF"])
    shader = nodes.new("ShaderNodeBsdfGlass")
    shader.inputs["Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["IOR"].default_value = ior
    links.new(shader.outputs["BSDF"], nodes["Material Output"].inputs["Surface"])
    return made


def emission(name, colour, strength):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.remove(nodes["Principled BSDF"])
    shader = nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = (*colour, 1)
    shader.inputs["Strength"].default_value = strength
    links.new(shader.outputs["Emission"], nodes["Material Output"].inputs["Surface"])
    return made


def bumpy(made, scale, strength, distance=0.05, stretch=(1, 1, 1), detail=4.0):
    """Adds noise bumps to a Principled material."""
    nodes, links = made.node_tree.nodes, made.node_tree.links
    place = nodes.new("ShaderNodeTexCoord")
    mapping = nodes.new("ShaderNodeMapping")
    mapping.inputs["Scale"].default_value = stretch
    noise = nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = scale
    noise.inputs["Detail"].default_value = detail
    bump = nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value = strength
    bump.inputs["Distance"].default_value = distance
    links.new(place.outputs["Object"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], noise.inputs["Vector"])
    links.new(noise.outputs[0], bump.inputs["Height"])
    links.new(bump.outputs["Normal"], nodes["Principled BSDF"].inputs["Normal"])
    return made


def _finish(obj, made, smooth=False):
    obj.data.materials.append(made)
    if smooth:
        obj.data.polygons.foreach_set("use_smooth", [True] * len(obj.data.polygons))
    return obj


def box(low, high, made, turn=0.0, bevel=0.0):
    """An axis-parallel box between two corners, turned about its vertical axis by `turn` degrees."""
    low, high = Vector(low), Vector(high)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(low + high) / 2, rotation=(0, 0, math.radians(turn)))
    obj = bpy.context.object
    obj.scale = high - low
    if bevel:
        bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
        modifier = obj.modifiers.new("Bevel", "BEVEL")
        modifier.width, modifier.segments = bevel, 3
    return _finish(obj, made)


def plane(centre, size, made):
    bpy.ops.mesh.primitive_plane_add(size=1, location=centre)
    obj = bpy.context.object
    obj.scale = (*size, 1)
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    return _finish(obj, made)


def sphere(centre, radius, made, segments=64):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2, radius=radius, location=centre)
    return _finish(bpy.context.object, made, smooth=True)


def torus(centre, major, minor, made, rotation=(0, 0, 0)):
    bpy.ops.mesh.primitive_torus_add(
        major_radius=major,
        minor_radius=minor,
        major_segments=96,
        minor_segments=32,
        location=centre,
        rotation=[math.radians(a) for a in rotation],
    )
    return _finish(bpy.context.object, made, smooth=True)


def cone(bottom, radius_bottom, radius_top, height, made, caps=True):
    """A truncated cone standing on `bottom`; equal radii make a cylinder."""
    bpy.ops.mesh.primitive_cone_add(
        vertices=64,
        radius1=radius_bottom,
        radius2=radius_top,
        depth=height,
        end_fill_type="NGON" if caps else "NOTHING",
        location=Vector(bottom) + Vector((0, 0, height / 2)),
    )
    obj = bpy.context.object
    _finish(obj, made)
    for face in obj.data.polygons:
        face.use_smooth = len(face.vertices) == 4
    return obj


def rock(centre, size, made, seed, rough=0.35):
    """A boulder: an icosphere displaced by two octaves of noise."""
    from mathutils import noise

    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5, radius=1, location=centre)
    obj = bpy.context.object
    shift = Vector((seed * 7.3, seed * 3.1, seed * 5.7))
    for vertex in obj.data.vertices:
        place = vertex.co + shift
        vertex.co *= 1 + rough * noise.noise(place * 1.3) + rough / 2.5 * noise.noise(place * 4)
    obj.scale = size
    return _finish(obj, made)


def lamp(kind, energy, location, colour=(1, 1, 1), target=None, **settings):
    """A lamp that points at `target`; `settings` are attributes of the lamp, such as its size."""
    data = bpy.data.lights.new(kind, kind)
    data.energy, data.color = energy, colour
    for key, value in settings.items():
        setattr(data, key, value)
    obj = bpy.data.objects.new(kind, data)
    obj.location = location
    if target is not None:
        obj.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(obj)
    return obj


def camera(location, target, lens, focus=None, fstop=2.8):
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    obj = bpy.data.objects.new("Camera", data)
    obj.location = location
    obj.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    if focus is not None:
        data.dof.use_dof = True
        data.dof.focus_distance = (Vector(focus) - Vector(location)).length
        data.dof.aperture_fstop = fstop
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.scene.camera = obj
    return obj


def sky(horizon, zenith, strength):
    """A sky that goes from one colour at the horizon to another overhead."""
    nodes, links = bpy.context.scene.world.node_tree.nodes, bpy.context.scene.world.node_tree.links
    place = nodes.new("ShaderNodeTexCoord")
    split = nodes.new("ShaderNodeSeparateXYZ")
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color = (*horizon, 1)
    ramp.color_ramp.elements[1].color = (*zenith, 1)
    ramp.color_ramp.elements[1].position = 0.6
    links.new(place.outputs["Generated"], split.inputs["Vector"])
    links.new(split.outputs["Z"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Background"].inputs["Color"])
    nodes["Background"].inputs["Strength"].default_value = strength


def light_groups(groups):
    """Puts objects (and the world, under the key of a scene) into named light groups, one pass each."""
    layer = bpy.context.view_layer
    for name, members in groups.items():
        layer.lightgroups.add(name=name)
        for member in members:
            member.lightgroup = name
