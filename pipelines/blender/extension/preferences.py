"""The preferences: paths of the programs. Programs of empty fields are searched."""

import bpy

from . import programs


class PolyreconPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="polyrecon",
        subtype="FILE_PATH",
        description="The program polyrecon. If empty: $POLYRECON, or the one on the PATH",
    )
    drivers: bpy.props.StringProperty(
        name="Drivers",
        subtype="DIR_PATH",
        description="The folder with adaptive.py. If empty: that of the checkout or installation of the program",
    )
    python: bpy.props.StringProperty(
        name="Python",
        subtype="FILE_PATH",
        description="Runs the adaptive loop; has numpy, OpenImageIO, jinja2 and rich. If empty: python3 on the PATH",
    )

    def draw(self, _context):
        draw(self.layout, self)


def draw(layout, chosen):
    """Draws the fields and the commands that follow from them."""
    for name in ("program", "drivers", "python"):
        layout.prop(chosen, name)
    for find in (lambda: [program()], lambda: driver_words("adaptive.py")):
        try:
            layout.label(text="found: " + " ".join(map(str, find())), icon="CHECKMARK")
        except programs.SetupError as error:
            layout.label(text=str(error), icon="ERROR")


def _chosen(name):
    value = getattr(bpy.context.preferences.addons[__package__].preferences, name)
    return bpy.path.abspath(value) if value else ""


def program():
    return programs.find_program(_chosen("program"))


def driver_words(name):
    return programs.driver_words(name, program(), bpy.app.binary_path, _chosen("drivers"), _chosen("python"))


CLASSES = (PolyreconPreferences,)
