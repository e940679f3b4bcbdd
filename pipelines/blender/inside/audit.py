"""Finds the effects of a frame, and switches off what does not change its picture (runs inside Blender)."""

import bpy

DYNAMIC_MODIFIERS = {
    "CLOTH",
    "SOFT_BODY",
    "FLUID",
    "DYNAMIC_PAINT",
    "EXPLODE",
    "OCEAN",
    "BUILD",
    "WAVE",
    "MESH_CACHE",
    "MESH_SEQUENCE_CACHE",
    "PARTICLE_SYSTEM",
    "PARTICLE_INSTANCE",
    "NODES",
}


def effects(scene, view_layer):
    """{effect: True, False or a number}, by the file's data. An effect that may be present counts as present."""
    shaders = [node for tree in _shader_trees() for node in tree.nodes]
    return {
        "volumes": any(_volume_linked(tree) for tree in _shader_trees()) or bool(bpy.data.volumes),
        "transmission": any(_transmits(node) for node in shaders),
        "hair": any(p.type == "HAIR" for p in bpy.data.particles) or bool(getattr(bpy.data, "hair_curves", ())),
        "depth of field": bool(scene.camera.data.dof.use_dof),
        "motion blur": bool(scene.render.use_motion_blur),
        "emission textures": any(_emits_texture(node) for node in shaders),
        "animation": moves(scene),
        "lamps": sum(o.type == "LIGHT" for o in view_layer.objects),
        "denoising": bool(scene.cycles.use_denoising),
        "scripted drivers": sum(
            1
            for owner in _data()
            for d in _drivers(owner)
            if d.driver.type == "SCRIPTED" and not d.driver.is_simple_expression
        ),
    }


def moves(scene):
    """Whether anything may change from one moment to the next. In doubt the answer is yes."""
    return bool(
        scene.rigidbody_world
        or any(_drivers(owner) or _animated(owner) for owner in _data())
        or any(m.type in DYNAMIC_MODIFIERS for o in scene.objects for m in o.modifiers)
        or any(o.particle_systems or o.constraints for o in scene.objects)
        or bpy.data.cache_files
    )


def _data():
    """All data blocks that can be animated."""
    for name in dir(bpy.data):
        collection = getattr(bpy.data, name)
        if isinstance(collection, bpy.types.bpy_prop_collection):
            for block in collection:
                yield block
                if getattr(block, "node_tree", None):
                    yield block.node_tree


def _drivers(owner):
    animation = getattr(owner, "animation_data", None)
    return animation.drivers if animation else ()


def _animated(owner):
    animation = getattr(owner, "animation_data", None)
    return bool(animation and (animation.action or animation.nla_tracks))


def _shader_trees():
    owners = [*bpy.data.materials, *bpy.data.worlds, *bpy.data.lights]
    trees = [owner.node_tree for owner in owners if owner.node_tree]
    return trees + [group for group in bpy.data.node_groups if group.bl_idname == "ShaderNodeTree"]


def _volume_linked(tree):
    return any(
        node.inputs["Volume"].is_linked
        for node in tree.nodes
        if node.bl_idname.startswith("ShaderNodeOutput") and "Volume" in node.inputs
    )


def _set_or_linked(node, names, zero):
    for name in names:
        socket = node.inputs.get(name)
        if socket and (socket.is_linked or not zero(socket.default_value)):
            return True
    return False


def _transmits(node):
    if node.bl_idname in (
        "ShaderNodeBsdfGlass",
        "ShaderNodeBsdfRefraction",
        "ShaderNodeBsdfTransparent",
        "ShaderNodeBsdfTranslucent",
    ):
        return True
    return node.bl_idname == "ShaderNodeBsdfPrincipled" and _set_or_linked(
        node, ("Transmission", "Transmission Weight"), lambda value: value == 0
    )


def _emits_texture(node):
    socket = node.inputs.get(
        {
            "ShaderNodeEmission": "Color",
            "ShaderNodeBackground": "Color",
            "ShaderNodeBsdfPrincipled": "Emission Color",
        }.get(node.bl_idname, "")
    )
    return bool(socket and socket.is_linked)


def switch_off(scene, view_layer, is_chosen):
    """Switches off what would spoil the samples or cannot change them; returns the arguments of the loop's Switch.

    is_chosen: whether the user named the view layer, and knows that others are left out."""
    switches = []

    def switch(owner, name, value, effect, reason, saves="", changes_picture=False):
        if hasattr(owner, name) and getattr(owner, name) != value:
            setattr(owner, name, value)
            found = {"effect": effect, "setting": "off", "reason": reason, "saves": saves}
            switches.append({**found, "changes_picture": changes_picture})

    render, cycles = scene.render, scene.cycles
    switch(
        cycles, "use_adaptive_sampling", False, "Cycles' adaptive sampling", "the loop decides where to take samples"
    )
    switch(
        cycles,
        "use_denoising",
        False,
        "Cycles' denoiser",
        "polyrecon reconstructs",
        "the denoiser's time in every pass",
    )
    switch(cycles, "time_limit", 0, "time limit of a render", "a pass must be complete")
    switch(cycles, "use_layer_samples", "IGNORE", "samples of the view layer", "the loop counts samples")
    switch(
        render, "use_compositing", False, "compositor", "it does not change the render layers", "its time in every pass"
    )
    switch(
        render, "use_sequencer", False, "sequencer", "it does not change the render layers", "its time in every pass"
    )
    for name, effect, reason in (
        ("use_freestyle", "Freestyle", "its scripts would run code of the file; no lines are drawn"),
        ("use_multiview", "stereo", "one view is rendered"),
        ("use_border", "render border", "the whole frame is rendered"),
    ):
        switch(render, name, False, effect, reason, changes_picture=True)
    if render.use_motion_blur and not moves(scene):
        switch(
            render,
            "use_motion_blur",
            False,
            "motion blur",
            "nothing in the file can move",
            "two more evaluations of the scene in every synchronisation",
        )
    for layer in scene.view_layers:
        if layer != view_layer:
            reason = f"{view_layer.name} is rendered; --view-layer renders another"
            switch(layer, "use", False, f"view layer {layer.name}", reason, changes_picture=not is_chosen)
    return switches
