#!/usr/bin/env python3
"""Makes docs/guide/pictures/blender_panel.png: the extension's panel, drawn by Debian's Blender on a virtual screen
(xvfb) with software OpenGL. POLYRECON_OIDN names the library of Open Image Denoise.

    tests/bench/blender/panel_picture.py [PROGRAM]

That Blender is older than extensions are, so the script registers the panel itself; Blender 4.2 and later draw the same
layout with newer icons."""

import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
TARGET = ROOT / "docs" / "guide" / "pictures" / "blender_panel.png"
WIDTH, HEIGHT = 1600, 1130  # of the window, so that the panel just fits into the properties


def draw_inside_blender():
    """Runs in Blender: shows the panel as it is after a job."""
    import importlib

    import bpy

    sys.path[:0] = [str(ROOT), str(ROOT / "pipelines" / "blender")]
    sys.modules["polyrecon_pipelines"] = importlib.import_module("pipelines")
    bpy.utils.register_cli_command = lambda *_: None  # since 4.2
    extension = importlib.import_module("extension")
    extension.panel.POLYRECON_PT_render.bl_options = set()  # open
    for panel in bpy.types.Panel.__subclasses__():
        if getattr(panel, "bl_context", "") == "render" and panel.is_registered:
            bpy.utils.unregister_class(panel)
    bpy.context.preferences.addons.new().module = "extension"
    extension.register()
    chosen = bpy.context.preferences.addons["extension"].preferences
    chosen.program, chosen.oidn = os.environ["POLYRECON"], os.environ.get("POLYRECON_OIDN", "")

    def look():
        area.spaces.active.context = "RENDER"
        job = extension.jobs.Job("Denoising", [["true"]], dict.fromkeys(("CLEAN", "NOISY", "ERROR"), TARGET))
        while job.poll():
            pass
        extension.jobs.current = job
        area.tag_redraw()
        bpy.app.timers.register(take, first_interval=2)

    def take():
        with bpy.context.temp_override(area=area):
            bpy.ops.screen.screenshot_area(filepath=os.environ["SHOT"])
        os._exit(0)  # Cycles cannot remove itself from panels that are gone.

    area = next(area for area in bpy.context.window.screen.areas if area.type == "PROPERTIES")
    bpy.context.preferences.view.show_splash = False
    bpy.context.scene.render.engine = "CYCLES"
    bpy.app.timers.register(look, first_interval=1)


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release" / "src" / "polyrecon")
    with tempfile.TemporaryDirectory() as folder:
        shot = pathlib.Path(folder) / "shot.png"
        environment = {
            **os.environ,
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "SHOT": str(shot),
            "POLYRECON": str(program.resolve()),
        }
        screen = ["xvfb-run", "--auto-servernum", "--server-args", f"-screen 0 {WIDTH}x{HEIGHT}x24"]
        size = ["--window-geometry", "0", "0", str(WIDTH), str(HEIGHT)]
        blender = ["blender", "--factory-startup", *size, "--python", __file__]
        subprocess.run([*screen, *blender], env=environment, check=True)
        os.replace(shot, TARGET)


if __name__ == "__main__":
    if "bpy" in sys.modules:
        draw_inside_blender()
    else:
        main()
