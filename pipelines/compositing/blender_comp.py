"""Opens a multilayer EXR in Blender's compositor: lists its layers, or grades objects that Cryptomatte names.

    blender -b -Y --factory-startup --python-exit-code 7 -P blender_comp.py -- clean.exr --list
    blender -b -Y --factory-startup --python-exit-code 7 -P blender_comp.py -- clean.exr \\
        -o graded.exr --object Torus --exposure 1

Works in Blender 3.4 to 5, and with Blender as a Python module (python3 blender_comp.py clean.exr ...). The result is a
float EXR: RGB is the picture, brighter by 2^exposure where the matte is 1; A is the matte.
"""

import argparse
import os
import struct
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
if not sys.dont_write_bytecode:  # A checkout stays as it is.
    sys.dont_write_bytecode = True

from common.modules import required

with required("blender_comp.py", ["bpy"]):
    import bpy

from common.terminal import print_lines, printable
from common.work_folder import WorkFolder

BLENDER_5 = bpy.app.version >= (5, 0)


def parse():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(prog="blender_comp.py", description="A multilayer EXR in Blender's compositor.")
    parser.add_argument("input", help="multilayer EXR")
    parser.add_argument("-o", "--output", help="EXR to write")
    parser.add_argument("--object", action="append", default=[], help="object to grade (repeatable)")
    parser.add_argument("--exposure", type=float, default=0.0, help="stops by which these objects become brighter")
    parser.add_argument("--list", action="store_true", help="print the layers that Blender finds, one a line")
    options = parser.parse_args(words)
    if not options.list and not (options.output and options.object):
        parser.error("give --list, or -o and --object")
    return options


def size_of(path):
    """Width and height of the first part, from the file's header; Blender reports them for single-layer images only."""
    mark = b"dataWindow\0box2i\0\x10\0\0\0"
    with open(path, "rb") as file:
        header = file.read(1 << 20)
    at = header.find(mark)
    if at < 0:
        raise SystemExit(printable(f"{path}: is not an EXR file"))
    x0, y0, x1, y1 = struct.unpack_from("<4i", header, at + len(mark))
    return x1 - x0 + 1, y1 - y0 + 1


def open_tree():
    """Empties the scene's compositor; returns its tree and the input of the final picture."""
    scene = bpy.context.scene
    if BLENDER_5:
        tree = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")
        scene.compositing_node_group = tree
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        output = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("CompositorNodeComposite")
    return tree, output.inputs["Image"]


def add_matte(tree, image, objects):
    """Adds a Cryptomatte node for objects of the file's first Cryptomatte layer; returns the matte."""
    node = tree.nodes.new("CompositorNodeCryptomatteV2")
    node.source = "IMAGE"
    node.image = image
    node.matte_id = ",".join(objects)
    return node.outputs["Matte"]


def add_grade(tree, picture, matte, stops):
    """Adds nodes for picture x 2^(stops x matte), with the matte as alpha; returns the result."""
    times = tree.nodes.new("ShaderNodeMath" if BLENDER_5 else "CompositorNodeMath")
    times.operation = "MULTIPLY"
    times.inputs[1].default_value = stops
    exposure = tree.nodes.new("CompositorNodeExposure")
    split = tree.nodes.new("CompositorNodeSeparateColor")
    join = tree.nodes.new("CompositorNodeCombineColor")
    tree.links.new(matte, times.inputs[0])
    tree.links.new(picture, exposure.inputs["Image"])
    tree.links.new(times.outputs[0], exposure.inputs["Exposure"])
    tree.links.new(exposure.outputs["Image"], split.inputs["Image"])
    for channel in ("Red", "Green", "Blue"):
        tree.links.new(split.outputs[channel], join.inputs[channel])
    tree.links.new(matte, join.inputs["Alpha"])
    return join.outputs["Image"]


def render(size, path):
    """Runs the compositor. Blender replaces '#' in output paths, so the file gets its name afterwards."""
    settings = bpy.context.scene.render
    settings.resolution_x, settings.resolution_y = size
    settings.resolution_percentage = 100
    settings.use_file_extension = False
    if BLENDER_5:
        settings.image_settings.media_type = "IMAGE"
    settings.image_settings.file_format = "OPEN_EXR"
    settings.image_settings.color_mode = "RGBA"
    settings.image_settings.color_depth = "32"
    folder = os.path.dirname(os.path.abspath(path))
    with WorkFolder("compositing", folder) as scratch:
        settings.filepath = str(scratch / "picture.exr")
        bpy.ops.render.render(write_still=True)
        os.replace(settings.filepath, path)


def main():
    options = parse()
    image = bpy.data.images.load(os.path.abspath(options.input))
    tree, result = open_tree()
    source = tree.nodes.new("CompositorNodeImage")
    source.image = image
    if options.list:
        for socket in source.outputs:
            print_lines(f"layer: {socket.name}")
    if options.output:
        matte = add_matte(tree, image, options.object)
        tree.links.new(add_grade(tree, source.outputs[0], matte, options.exposure), result)
        render(size_of(options.input), options.output)


main()
