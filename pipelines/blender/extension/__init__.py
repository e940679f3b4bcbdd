"""polyrecon in Blender: a panel in Render Properties, preferences, and `blender -c polyrecon`."""

import bpy

from . import command_line, jobs, operators, panel, preferences, programs, settings

_classes = (*settings.CLASSES, *preferences.CLASSES, *operators.CLASSES, *panel.CLASSES)
_command = None


def register():
    global _command
    programs.make_executable()
    for cls in _classes:
        bpy.utils.register_class(cls)
    bpy.types.Scene.polyrecon = bpy.props.PointerProperty(type=settings.PolyreconSettings)
    _command = bpy.utils.register_cli_command("polyrecon", command_line.run)


def unregister():
    jobs.end()
    bpy.utils.unregister_cli_command(_command)
    del bpy.types.Scene.polyrecon
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
