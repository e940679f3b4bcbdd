"""The files that a picture depends on (runs inside Blender)."""

import glob
import os
import re

import bpy
import caches

CACHE_FILE = re.compile(r".+\.bphys|(?:disp|foam|normal|spray|spray_inverse)_\d+\.exr")  # of points, of an ocean


def version_of(path):
    """The version of Blender that saved a file which this Blender may not be able to open; None if it is unknown."""
    with open(path, "rb") as file:
        start = file.read(64)
    # "BLENDER-v304", and since Blender 5.0 "BLENDER17-01v0500". Compressed files begin with the same bytes after some
    # of their own, since a first occurrence cannot be compressed.
    found = re.search(rb"BLENDER(?:[-_][vV]|\d\d-\d\dv0)(\d)(\d\d)", start)
    return (int(found[1]), int(found[2])) if found else None


def opened(path):
    """The .blend files that were read when the scene was opened."""
    return sorted({path, *(_absolute(library, library.filepath) for library in bpy.data.libraries)})


def used():
    """{name: files and folders} that are read while frames are evaluated and rendered. A sequence has one name."""
    sequences = dict(_sequences())
    found = {path: _parts(path) for path in bpy.utils.blend_paths(absolute=True, packed=False, local=False) if path}
    for blend in opened(bpy.data.filepath):
        found.pop(blend, None)
        stem = os.path.splitext(os.path.basename(blend))[0]
        folder = os.path.join(os.path.dirname(blend), f"blendcache_{stem}")  # of point caches
        if os.path.isdir(folder):
            found[folder] = [folder]
    named = (os.path.realpath(path) for path in _names_in_nodes())
    return {**found, **{path: [path] for path in named if os.path.isfile(path)}, **sequences}


def _parts(path):
    """The file itself, or the files and folders of the caches in a folder: of an ocean, of points, of a fluid. Other
    files in it, such as results, are none of the scene's."""
    if not os.path.isdir(path):
        return [path]
    files = sorted(entry.path for entry in os.scandir(path) if CACHE_FILE.fullmatch(entry.name))
    return files + [os.path.join(path, name) for name in caches.FLUID_FOLDERS]


def _names_in_nodes():
    """Texts of nodes and of their modifiers, which may be paths: importing nodes read files."""
    for tree in bpy.data.node_groups:
        for node in tree.nodes:
            texts = (socket.default_value for socket in node.inputs if socket.type == "STRING")
            yield from (bpy.path.abspath(text, library=tree.library) for text in texts if text)
    for owner in bpy.data.objects:
        for modifier in owner.modifiers:
            texts = modifier.values() if modifier.type == "NODES" else ()
            yield from (bpy.path.abspath(t, library=owner.library) for t in texts if isinstance(t, str) and t)


def _sequences():
    for owner in (*bpy.data.images, *bpy.data.movieclips, *bpy.data.cache_files, *bpy.data.volumes):
        path = _absolute(owner, owner.filepath)
        folder, name = os.path.split(path)
        if getattr(owner, "source", "") == "SEQUENCE" or getattr(owner, "is_sequence", False):
            pattern = re.sub(r"\d+(?=\D*$)", "\0", name)
        elif getattr(owner, "source", "") == "TILED":
            pattern = re.sub("<UDIM>|<UVTILE>", "\0", name)
        else:
            continue
        yield path, sorted(glob.glob(os.path.join(glob.escape(folder), glob.escape(pattern).replace("\0", "*"))))


def _absolute(owner, path):
    return os.path.realpath(bpy.path.abspath(path, library=owner.library))
