"""The panel in Render Properties."""

import os
import textwrap

import bpy

from . import jobs, preferences

DEFAULT_LETTERS = 60  # of a line, where there is no window


class POLYRECON_PT_render(bpy.types.Panel):
    bl_label = "polyrecon"
    bl_idname = "POLYRECON_PT_render"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}
    COMPAT_ENGINES = {"CYCLES"}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context):
        chosen, layout, letters = context.scene.polyrecon, self.layout, _letters(context)
        layout.use_property_split, layout.use_property_decorate = True, False
        problems = preferences.problems()
        if problems:
            box = layout.box()
            for problem in problems:
                _draw_text(box, problem, "ERROR", letters)
            box.operator("polyrecon.preferences", icon="PREFERENCES")
        if jobs.current:
            _draw_job(layout.box(), jobs.current, letters)
        layout.prop(chosen, "quality")
        layout.prop(chosen, "output")
        _draw_switches(layout, chosen, "second_opinion", "light_passes")

        column = layout.column()
        column.operator("polyrecon.set_up_passes", icon="RENDERLAYERS")
        column.operator("polyrecon.denoise", icon="SHADERFX")

        layout.separator()
        layout.prop(chosen, "frames")
        layout.operator("polyrecon.render", icon="RENDER_STILL")

        layout.separator()
        layout.prop(chosen, "limit")
        layout.prop(chosen, {"SECONDS": "seconds", "SPP": "spp", "TARGET": "target"}[chosen.limit])
        _draw_switches(layout, chosen, "resume")
        layout.operator("polyrecon.adaptive", icon="RENDER_STILL")

        layout.separator()
        layout.prop(chosen, "folder")
        layout.operator("polyrecon.frames", icon="FILE_FOLDER")


def _draw_switches(layout, chosen, *names):
    """Switches that are as wide as the panel, since half of it is too narrow for their labels."""
    column = layout.column(align=True)
    column.use_property_split = False
    for name in names:
        column.prop(chosen, name)


def _letters(context):
    """About how many letters a line of the panel has."""
    region = context.region
    return max(24, int(region.width / (7.5 * context.preferences.system.ui_scale)) - 8) if region else DEFAULT_LETTERS


def _draw_text(box, text, icon, letters):
    """Draws a text of several lines, as Blender cuts a label that is too long."""
    for number, line in enumerate(textwrap.wrap(text, letters)):
        box.label(text=line, icon="BLANK1" if number else icon)


def _draw_job(box, job, letters):
    if job.running:
        row = box.row()
        row.progress(factor=job.fraction, text=f"{job.title}: {job.phase}, {job.seconds:.0f} s")
        row.operator("polyrecon.cancel", text="", icon="X")
    elif job.state == "failed":
        _draw_text(box, job.error, "ERROR", letters)
    else:
        box.label(text=f"{job.title}: {job.state}", icon="CHECKMARK" if job.state == "done" else "CANCEL")
    for missing, how in job.advice:
        _draw_text(box, f"Could be better: {missing}. {how}", "INFO", letters)
    shown = [name for name, path in job.results.items() if os.path.exists(path) and name != "COMPARE"]
    if shown and not job.running:
        row = box.row(align=True)
        for name in shown:
            row.operator("polyrecon.show", text=name.title()).which = name
        if {"CLEAN", "NOISY"} <= set(shown):
            column = box.column(align=True)
            column.operator("polyrecon.compare", icon="ARROW_LEFTRIGHT")
            column.operator("polyrecon.compositor", icon="NODE_COMPOSITING")


CLASSES = (POLYRECON_PT_render,)
