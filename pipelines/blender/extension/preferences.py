"""Where the programs are; empty fields are found by themselves."""

import bpy

from . import programs


class PolyreconPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="polyrecon", subtype="FILE_PATH", description="The program polyrecon; empty: $POLYRECON, or on the PATH"
    )
    drivers: bpy.props.StringProperty(
        name="Drivers", subtype="DIR_PATH", description="The folder with adaptive.py; empty: found by the program"
    )
    python: bpy.props.StringProperty(
        name="Python",
        subtype="FILE_PATH",
        description="A Python with numpy, OpenImageIO, jinja2 and rich, which runs the adaptive loop; empty: python3 on the PATH",
    )

    def draw(self, _context):
        draw(self.layout, self)


def draw(layout, chosen):
    """The fields, and what they come to."""
    for name in ("program", "drivers", "python"):
        layout.prop(chosen, name)
    for find in (lambda: [program()], lambda: driver_words("adaptive.py")):
        try:
            layout.label(text="found: " + " ".join(map(str, find())), icon="CHECKMARK")
        except programs.Problem as problem:
            layout.label(text=str(problem), icon="ERROR")


def _chosen(name):
    value = getattr(bpy.context.preferences.addons[__package__].preferences, name)
    return bpy.path.abspath(value) if value else ""


def program():
    return programs.find_program(_chosen("program"))


def driver_words(name):
    return programs.driver_words(name, program(), bpy.app.binary_path, _chosen("drivers"), _chosen("python"))


CLASSES = (PolyreconPreferences,)
