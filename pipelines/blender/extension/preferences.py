"""The preferences. Nothing has to be set: empty fields are filled by what comes with the extension and with Blender."""

import bpy

from . import programs


class PolyreconPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="Program",
        subtype="FILE_PATH",
        description="Another program polyrecon. If empty: the one that comes with the extension",
    )
    oidn: bpy.props.StringProperty(
        name="Open Image Denoise",
        subtype="FILE_PATH",
        description="Another libOpenImageDenoise.so.2, or its folder. If empty: the one that Blender has",
    )

    def draw(self, _context):
        draw(self.layout, self)


def draw(layout, chosen):
    """Draws the fields, and what was found."""
    for name in ("program", "oidn"):
        layout.prop(chosen, name)
    for find in (program, oidn):
        try:
            layout.label(text=f"found: {find()}", icon="CHECKMARK")
        except programs.SetupError as error:
            layout.label(text=str(error), icon="ERROR")


def _chosen(name):
    value = getattr(bpy.context.preferences.addons[__package__].preferences, name)
    return bpy.path.abspath(value) if value else ""


def program():
    """The path of the program."""
    return programs.find_program(_chosen("program"))


def oidn():
    """The library of Open Image Denoise."""
    found = programs.find_oidn(_chosen("oidn"))
    if not found:
        raise programs.SetupError("Open Image Denoise was not found: install it, or name its library")
    return found


def problems():
    """What is missing, as texts of one line."""
    found = []
    for find in (program, oidn):
        try:
            find()
        except programs.SetupError as error:
            found.append(str(error))
    return found


def environment():
    return programs.environment(programs.find_oidn(_chosen("oidn")))


def driver_words(name):
    return programs.driver_words(name, bpy.app.binary_path)


CLASSES = (PolyreconPreferences,)
