"""Puts the last result into the compositor: its passes in place of the render's, and how much noise to keep."""

import bpy

from .programs import SetupError

GROUP = "polyrecon: Keep Noise"
CLEAN, NOISY = "polyrecon: Clean", "polyrecon: Noisy"  # names of the nodes that are added
PICTURE = {"Combined": "Image"}  # the pass of a file, and what a Render Layers node calls it
SPACING = 320  # between nodes


def use_result(scene, clean, noisy, frames):
    """Adds the files to the scene's compositor, and moves the links of its Render Layers nodes to the clean passes of
    the same name. The picture passes the group GROUP first. Returns how many links were moved.

    frames: whose files these are; of several, `clean` and `noisy` are those of one. noisy: None where frames have no
    file of that kind with their number; the picture then is the clean one. A second call puts the files into the nodes
    that are there."""
    tree = _tree(scene)
    clean_node = _image_node(tree, CLEAN, clean, frames)
    clean_passes = {PICTURE.get(output.name, output.name): output for output in clean_node.outputs}
    if noisy:
        group = _group_node(tree)
        tree.links.new(clean_passes["Image"], group.inputs["Clean"])
        tree.links.new(_image_node(tree, NOISY, noisy, frames).outputs["Combined"], group.inputs["Noisy"])
        clean_passes["Image"] = group.outputs["Image"]
    moved = 0
    for node in [node for node in tree.nodes if node.bl_idname == "CompositorNodeRLayers"]:
        for output in node.outputs:
            for link in list(output.links):
                if source := clean_passes.get(output.name):
                    tree.links.new(source, link.to_socket)
                    moved += 1
    return moved


def _tree(scene):
    """The scene's compositor, which is made if there is none."""
    if not hasattr(scene, "compositing_node_group"):  # before Blender 5
        scene.use_nodes = True
        return scene.node_tree
    if not scene.compositing_node_group:
        tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        render, output = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("NodeGroupOutput")
        render.scene, output.location = scene, (2 * SPACING, 0)
        tree.links.new(render.outputs["Image"], output.inputs["Image"])
        scene.compositing_node_group = tree
    return scene.compositing_node_group


def _image_node(tree, name, path, frames):
    node = tree.nodes.get(name)
    if not node:
        node = tree.nodes.new("CompositorNodeImage")
        node.name = node.label = name
        node.location = (0, 0 if name == CLEAN else -SPACING)
    node.image = bpy.data.images.load(str(path), check_existing=True)
    node.image.reload()
    if len(frames) > 1:
        node.image.source = "SEQUENCE"
        node.frame_start, node.frame_offset = frames[0], frames[0] - 1
        node.frame_duration = frames[-1] - frames[0] + 1
    if "Combined" not in node.outputs:
        raise SetupError(f"{path.name}: holds no Combined pass")
    return node


def _group_node(tree):
    found = next((node for node in tree.nodes if getattr(node, "node_tree", None) == _group()), None)
    if found:
        return found
    node = tree.nodes.new("CompositorNodeGroup")
    node.node_tree = _group()
    node.location = (SPACING, 0)
    return node


def _group():
    """The group, which is made at its first use."""
    group = bpy.data.node_groups.get(GROUP)
    if group:
        return group
    group = bpy.data.node_groups.new(GROUP, "CompositorNodeTree")
    for name in ("Clean", "Noisy"):
        group.interface.new_socket(name, in_out="INPUT", socket_type="NodeSocketColor")
    kept = group.interface.new_socket("Noise Kept", in_out="INPUT", socket_type="NodeSocketFloat")
    kept.subtype, kept.min_value, kept.max_value, kept.default_value = "FACTOR", 0, 1, 0
    kept.description = "0: the clean picture, 1: the noisy one"
    group.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    begin, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    begin.location, end.location = (-SPACING, 0), (SPACING, 0)
    factor, first, second, mixed = _mix_sockets(group)
    for name, socket in (("Noise Kept", factor), ("Clean", first), ("Noisy", second)):
        group.links.new(begin.outputs[name], socket)
    group.links.new(mixed, end.inputs["Image"])
    return group


def _mix_sockets(group):
    """A node that mixes colours: its inputs for the factor and both colours, and its output."""
    if bpy.app.version < (5, 0):
        mix = group.nodes.new("CompositorNodeMixRGB")
        return mix.inputs[0], mix.inputs[1], mix.inputs[2], mix.outputs[0]
    mix = group.nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    inputs = {socket.identifier: socket for socket in mix.inputs}
    output = next(socket for socket in mix.outputs if socket.identifier == "Result_Color")
    return inputs["Factor_Float"], inputs["A_Color"], inputs["B_Color"], output
