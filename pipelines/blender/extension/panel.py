"""The panel in Render Properties."""

import os
import textwrap

import bpy

from . import jobs

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
        chosen, layout = context.scene.polyrecon, self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(chosen, "output")
        layout.operator("polyrecon.set_up_passes", icon="RENDERLAYERS")
        layout.operator("polyrecon.denoise", icon="SHADERFX")
        layout.separator()
        layout.row().prop(chosen, "limit", expand=True)
        layout.prop(chosen, {"SECONDS": "seconds", "SPP": "spp", "TARGET": "target"}[chosen.limit])
        layout.row().prop(chosen, "frames", expand=True)
        layout.prop(chosen, "resume")
        layout.operator("polyrecon.adaptive", icon="RENDER_STILL")
        if jobs.current:
            _draw_job(layout.box(), jobs.current, _letters(context))


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
    shown = [name for name, path in job.results.items() if os.path.exists(path)]
    if shown and not job.running:
        row = box.row(align=True)
        for name in shown:
            row.operator("polyrecon.show", text=name.title()).which = name


CLASSES = (POLYRECON_PT_render,)
