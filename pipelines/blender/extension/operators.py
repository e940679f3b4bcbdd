"""The operators of the panel's buttons. None of them waits for a program."""

import os
import pathlib
import shutil

import bpy

from . import jobs, preferences
from .programs import SetupError


class _Operator:
    """An operator whose `work` may raise SetupError, which becomes its error message."""

    def execute(self, context):
        try:
            self.work(context)
        except (SetupError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class _Start(_Operator):
    @classmethod
    def poll(cls, _context):
        if jobs.current and jobs.current.running:
            cls.poll_message_set("polyrecon is running")
            return False
        return True


class POLYRECON_OT_set_up_passes(_Operator, bpy.types.Operator):
    """Store the passes that the reconstruction reads, and no denoised picture over the noisy one"""

    bl_idname = "polyrecon.set_up_passes"
    bl_label = "Set Up Passes"
    bl_options = {"REGISTER", "UNDO"}

    def work(self, context):
        changed = set_up_passes(context.scene, context.view_layer)
        self.report({"INFO"}, "changed: " + ", ".join(changed) if changed else "everything is set up already")


def set_up_passes(scene, view_layer):
    """Sets up the passes; returns the names of the changed settings."""
    wanted = (
        ("engine Cycles", scene.render, "engine", "CYCLES"),
        ("denoising features", view_layer.cycles, "denoising_store_passes", True),
        ("sample count", view_layer.cycles, "pass_debug_sample_count", True),
        ("Cycles' denoiser off", scene.cycles, "use_denoising", False),
        ("adaptive sampling off", scene.cycles, "use_adaptive_sampling", False),
    )
    changed = [name for name, owner, attribute, value in wanted if getattr(owner, attribute) != value]
    for _, owner, attribute, value in wanted:
        setattr(owner, attribute, value)
    return changed


class POLYRECON_OT_denoise(_Start, bpy.types.Operator):
    """Denoise the frame that was rendered last"""

    bl_idname = "polyrecon.denoise"
    bl_label = "Denoise This Frame"

    def work(self, context):
        scene = context.scene
        clean = scene.polyrecon.output_of(scene.frame_current)
        program = preferences.program()
        clean.parent.mkdir(parents=True, exist_ok=True)
        results = _results(clean)
        _save_render(scene, results["NOISY"])
        error_map = results["ERROR"].with_suffix(".exr")
        report = pathlib.Path(bpy.app.tempdir) / "polyrecon_report.json"
        denoise = [program, "denoise", "-i", results["NOISY"], "-o", clean, "--error-map", error_map]
        denoise += ["--report", report, "--overwrite", "--progress", "json"]
        jobs.start("Denoise", [denoise, _error_picture(program, error_map, results)], results, report)


def _results(clean):
    """The pictures of one frame that the panel shows. ERROR is the error map in false colours."""
    return {
        "CLEAN": clean,
        "NOISY": clean.with_name(clean.stem + "_noisy.exr"),
        "ERROR": clean.with_name(clean.stem + "_error.png"),
    }


def _error_picture(program, error_map, results):
    return [program, "preview", error_map, "-o", results["ERROR"], "--overwrite"]


def _save_render(scene, path):
    """Saves the last render with all its passes. The scene's output settings do not change."""
    render = bpy.data.images.get("Render Result")
    if render is None:
        raise SetupError("there is no render yet: render the frame first")
    settings = scene.render.image_settings
    wanted = {"file_format": "OPEN_EXR_MULTILAYER", "color_depth": "32", "exr_codec": "ZIP"}
    if hasattr(settings, "media_type"):  # Blender 5: must be set before the format
        wanted = {"media_type": "MULTI_LAYER_IMAGE", **wanted}
    before = {name: getattr(settings, name) for name in wanted}
    try:
        for name, value in wanted.items():
            setattr(settings, name, value)
        render.save_render(str(path), scene=scene)
    except RuntimeError as error:
        raise SetupError("there is no render yet: render the frame first") from error
    finally:
        for name, value in before.items():
            setattr(settings, name, value)


class POLYRECON_OT_adaptive(_Start, bpy.types.Operator):
    """Render a copy of the scene in the background, with samples where the reconstruction needs them"""

    bl_idname = "polyrecon.adaptive"
    bl_label = "Render Adaptively"

    def work(self, context):
        scene = context.scene
        chosen = scene.polyrecon
        if scene.render.engine != "CYCLES":
            raise SetupError("adaptive rendering needs Cycles: choose it as the render engine")
        words, program = preferences.driver_words("adaptive.py"), preferences.program()
        frames = chosen.frames_of(scene)
        outputs = {frame: chosen.output_of(frame) for frame in frames}
        if len(set(outputs.values())) < len(frames):
            raise SetupError(f"{chosen.output}: several frames need #### in the file's name")
        last = outputs[frames[-1]]
        last.parent.mkdir(parents=True, exist_ok=True)
        copy = last.parent / "polyrecon_scene.blend"
        if not (chosen.resume and copy.exists()):
            _forget(outputs.values())
            bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True, check_existing=False)
        words += [copy, "-o", chosen.output_pattern(), *chosen.limit_words(), *chosen.frames_words(scene)]
        words += ["--polyrecon", program, "--progress", "json", "--keep-passes", "--overwrite"]
        words += ["--resume"] if chosen.resume else []
        passes = _passes(last)
        results = {
            "CLEAN": last,
            "NOISY": passes / "merged.exr",
            "ERROR": passes / "error.png",
            "REPORT": passes / "report.html",
        }
        jobs.start("Adaptive", [words, _error_picture(program, passes / "error.exr", results)], results)


def _passes(clean):
    """The folder of a frame's passes."""
    return clean.with_suffix(".passes")


def _forget(outputs):
    """Removes passes of an earlier scene, which the loop would refuse."""
    for folder in map(_passes, outputs):
        if (folder / "journal.json").exists():
            shutil.rmtree(folder)


class POLYRECON_OT_cancel(bpy.types.Operator):
    """Stop the job in the background. Finished files are kept"""

    bl_idname = "polyrecon.cancel"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, _context):
        return jobs.current is not None and jobs.current.running

    def execute(self, _context):
        jobs.current.cancel()
        return {"FINISHED"}


class POLYRECON_OT_show(_Operator, bpy.types.Operator):
    """Show a picture of the last job in an image editor"""

    bl_idname = "polyrecon.show"
    bl_label = "Show"

    which: bpy.props.EnumProperty(
        items=(("CLEAN", "Result", ""), ("NOISY", "Noisy", ""), ("ERROR", "Error Map", ""), ("REPORT", "Report", ""))
    )

    def work(self, context):
        path = jobs.current.results.get(self.which) if jobs.current else None
        if path is None or not os.path.exists(path):
            raise SetupError("there is no such picture yet: run the job first")
        if self.which == "REPORT":
            if not bpy.app.background:
                bpy.ops.wm.url_open(url=path.as_uri())
            return
        image = bpy.data.images.load(str(path), check_existing=True)
        image.reload()
        space = _image_editor(context)
        if space:
            space.image = image


def _image_editor(context):
    """The first image editor of any window, or else one in a new window; None without windows."""
    manager = context.window_manager
    for window in manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                return area.spaces.active
    if bpy.app.background or not manager.windows:
        return None
    bpy.ops.wm.window_new()
    area = manager.windows[-1].screen.areas[0]
    area.type = "IMAGE_EDITOR"
    return area.spaces.active


CLASSES = (
    POLYRECON_OT_set_up_passes,
    POLYRECON_OT_denoise,
    POLYRECON_OT_adaptive,
    POLYRECON_OT_cancel,
    POLYRECON_OT_show,
)
