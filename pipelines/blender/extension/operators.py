"""The operators of the panel's buttons. None of them waits for a program."""

import os
import pathlib
import shutil

import bpy

from . import compositor, jobs, preferences, settings
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
            cls.poll_message_set("a job is running: wait for it or stop it")
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
    """Denoise the frame that was rendered last (F12)"""

    bl_idname = "polyrecon.denoise"
    bl_label = "Denoise Last Render"

    def work(self, context):
        scene = context.scene
        chosen = scene.polyrecon
        results = _results(chosen.output_of(scene.frame_current))
        words = _denoise_words(chosen)
        results["CLEAN"].parent.mkdir(parents=True, exist_ok=True)
        _save_render(scene, results["NOISY"])
        _start("Denoising", [], words, results)


class POLYRECON_OT_render(_Start, bpy.types.Operator):
    """Render the scene's samples in parts that show how noisy each pixel is, and denoise with that. The same samples
    give a better picture than one render, and a true error map"""

    bl_idname = "polyrecon.render"
    bl_label = "Render with Error Estimate"

    def work(self, context):
        scene = context.scene
        chosen = scene.polyrecon
        _require_cycles(scene)
        outputs = chosen.outputs(scene)
        words = _denoise_words(chosen)
        parts, samples = _parts(scene.cycles.samples)
        copy = _save_copy(outputs)
        pattern = chosen.output_pattern() if len(outputs) > 1 else next(iter(outputs.values()))
        render = [*preferences.driver_words("render_passes"), copy, "-o", _results(pattern)["NOISY"]]
        render += ["--spp", str(samples), "--parts", str(parts), *_device_words(context), *chosen.frames_words(scene)]
        render += ["--polyrecon", preferences.program(), "--progress", "json", "--overwrite"]
        if len(outputs) > 1:
            words += [f"--frames={scene.frame_start}-{scene.frame_end}x{scene.frame_step}"]
        last = _results(list(outputs.values())[-1])
        _start("Render", [render], words, last, pattern if len(outputs) > 1 else None)


def _parts(samples):
    """(parts, samples) of a render with an error estimate: samples are rounded up to whole parts."""
    parts = min(settings.PARTS, max(samples, 2))
    return parts, -(-max(samples, 2) // parts) * parts


class POLYRECON_OT_adaptive(_Start, bpy.types.Operator):
    """Render with samples where noise is left, until the time, the samples or the noise below are reached"""

    bl_idname = "polyrecon.adaptive"
    bl_label = "Render Adaptively"

    def work(self, context):
        scene = context.scene
        chosen = scene.polyrecon
        _require_cycles(scene)
        outputs = chosen.outputs(scene)
        words, program = preferences.driver_words("adaptive"), preferences.program()
        last = list(outputs.values())[-1]
        copy = last.parent / COPY
        if not (chosen.resume and copy.exists()):
            _forget(chosen.passes(scene))
            copy = _save_copy(outputs)
        words += [copy, "-o", chosen.output_pattern(), *chosen.limit_words(), *chosen.frames_words(scene)]
        words += [*_device_words(context), "--quality", chosen.quality]
        words += ["--with-prior"] if _second_opinion(chosen) else []
        words += ["--polyrecon", program, "--progress", "json", "--keep-passes", "--overwrite"]
        words += ["--resume"] if chosen.resume else []
        passes = chosen.passes(scene)[-1]
        results = {
            "CLEAN": last,
            "NOISY": passes / "merged.exr",
            "ERROR": passes / "error.png",
            "REPORT": passes / "report.html",
        }
        commands = [words, _error_picture(program, passes / "error.exr", results)]
        jobs.start("Render", commands, results, environment=preferences.environment())


class POLYRECON_OT_frames(_Start, bpy.types.Operator):
    """Denoise all renders in a folder. Frames that are done already are skipped"""

    bl_idname = "polyrecon.frames"
    bl_label = "Denoise Frames on Disk"

    def work(self, context):
        chosen = context.scene.polyrecon
        if not chosen.folder:
            raise SetupError("choose the folder with the renders first")
        folder = settings.absolute(chosen.folder, "folder")
        if not folder.is_dir():
            raise SetupError(f"{folder}: no such folder")
        words = [*_denoise_words(chosen), "-i", folder, "-o", folder / "denoised", "--skip-existing"]
        (folder / "denoised").mkdir(exist_ok=True)
        jobs.start("Denoising", [words], {"FOLDER": folder / "denoised"}, environment=preferences.environment())


COPY = "polyrecon_scene.blend"


def _require_cycles(scene):
    if scene.render.engine != "CYCLES":
        raise SetupError("this needs Cycles: choose it as the render engine")


def _save_copy(outputs):
    """Saves a copy of the scene next to the outputs, which Blender renders in the background."""
    folder = list(outputs.values())[-1].parent
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / COPY), copy=True, check_existing=False)
    return folder / COPY


def _device_words(context):
    """The drivers' option for the device: as the scene and the user's preferences say."""
    cycles = context.preferences.addons.get("cycles")
    no_card = cycles is None or cycles.preferences.compute_device_type == "NONE"
    return ["--device", "cpu" if no_card else "auto"]


def _second_opinion(chosen):
    """Whether Open Image Denoise is used: if it is chosen, and found."""
    if not chosen.second_opinion:
        return False
    try:
        preferences.oidn()
    except SetupError:
        return False
    return True


def _denoise_words(chosen):
    """`polyrecon denoise` with what is chosen in the panel."""
    words = [preferences.program(), "denoise", "--quality", chosen.quality, "--overwrite", "--progress", "json"]
    words += ["--prior", "oidn"] if _second_opinion(chosen) else []
    words += ["--aov", "all"] if chosen.light_passes else []
    return words


def _start(title, commands, denoise, results, pattern=None):
    """Starts the commands, and after them `denoise` and what makes the error map visible. results: of the last frame.
    pattern: the name of the results of several frames."""
    every = _results(pattern or results["CLEAN"])
    report = None if pattern else pathlib.Path(bpy.app.tempdir) / "polyrecon_report.json"  # of one frame
    denoise = [*denoise, "-i", every["NOISY"], "-o", every["CLEAN"], "--error-map", every["ERROR"].with_suffix(".exr")]
    denoise += ["--report", report] if report else []
    picture = _error_picture(preferences.program(), results["ERROR"].with_suffix(".exr"), results)
    jobs.start(title, [*commands, denoise, picture], results, report, preferences.environment())


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


def _forget(folders):
    """Removes passes of an earlier scene, which the loop would refuse."""
    for folder in folders:
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


class POLYRECON_OT_preferences(bpy.types.Operator):
    """Open the preferences of the add-on, which say what is missing"""

    bl_idname = "polyrecon.preferences"
    bl_label = "Open Preferences"

    def execute(self, _context):
        bpy.ops.preferences.addon_show(module=__package__)
        return {"FINISHED"}


class POLYRECON_OT_show(_Operator, bpy.types.Operator):
    """Show this picture in an image editor"""

    bl_idname = "polyrecon.show"
    bl_label = "Show"

    which: bpy.props.EnumProperty(
        items=(
            ("CLEAN", "Result", ""),
            ("NOISY", "Noisy", ""),
            ("ERROR", "Error Map", ""),
            ("COMPARE", "Compare", ""),
            ("REPORT", "Report", ""),
            ("FOLDER", "Folder", ""),
        )
    )

    def work(self, context):
        path = jobs.current.results.get(self.which) if jobs.current else None
        if path is None or not os.path.exists(path):
            raise SetupError("there is no such picture yet: run the job first")
        if self.which in ("COMPARE", "REPORT", "FOLDER"):
            open_outside(path)
            return
        space = image_editor(context) or _new_image_editor(context)
        show(path, space)


def open_outside(path):
    """Opens a page or a folder in the system's browser. The page of POLYRECON_OT_compare begins with the slider."""
    if not bpy.app.background:
        bpy.ops.wm.url_open(url=path.as_uri() + ("#mode=wipe" if path.suffix == ".html" else ""))


class POLYRECON_OT_compare(_Start, bpy.types.Operator):
    """Make a page with a slider between the noisy picture and the result, the error map, and the values of each pixel,
    and open it in the browser"""

    bl_idname = "polyrecon.compare"
    bl_label = "Compare"

    def work(self, context):
        clean, noisy = _clean_and_noisy()
        files, page = [noisy, clean], clean.with_name(clean.stem + "_compare.html")
        error = jobs.current.results["ERROR"].with_suffix(".exr")
        files += [error] if error.exists() else []
        words = [preferences.program(), "view", *files, "-o", page, "--overwrite"]
        results = {**jobs.current.results, "COMPARE": page}
        jobs.start("Comparing", [words], results, environment=preferences.environment())


class POLYRECON_OT_compositor(_Operator, bpy.types.Operator):
    """Use the clean passes in the compositor in place of the render's, with a node that says how much noise to keep"""

    bl_idname = "polyrecon.compositor"
    bl_label = "Use in Compositor"
    bl_options = {"REGISTER", "UNDO"}

    def work(self, context):
        clean, noisy = _clean_and_noisy()
        chosen = context.scene.polyrecon
        frames = chosen.frames_of(context.scene)
        if clean not in chosen.outputs(context.scene).values():
            frames = [context.scene.frame_current]
        numbered = len(frames) == 1 or noisy.parent == clean.parent  # not those of adaptive renders
        links = compositor.use_result(context.scene, clean, noisy if numbered else None, frames)
        self.report({"INFO"}, f"{links} links of the render's passes now come from {clean.name}")


def _clean_and_noisy():
    """The result of the last job and the picture that it was made of."""
    results = jobs.current.results if jobs.current else {}
    files = [results.get(name) for name in ("CLEAN", "NOISY")]
    if not all(file and file.exists() for file in files):
        raise SetupError("there is no result yet: denoise a render first")
    return files


def show(path, space):
    """Loads a picture, and shows it in an image editor's space if there is one."""
    image = bpy.data.images.load(str(path), check_existing=True)
    image.reload()
    if space:
        space.image = image


def image_editor(context):
    """The first image editor of any window, such as the one with the render; None if there is none."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                return area.spaces.active
    return None


def _new_image_editor(context):
    """An image editor in a new window; None without windows."""
    manager = context.window_manager
    if bpy.app.background or not manager.windows:
        return None
    bpy.ops.wm.window_new()
    area = manager.windows[-1].screen.areas[0]
    area.type = "IMAGE_EDITOR"
    return area.spaces.active


def show_result(job):
    """Shows the result of a job that is done, where an image editor is open."""
    clean, page = job.results.get("CLEAN"), job.results.get("COMPARE")
    if job.state == "done" and page and page.exists():
        open_outside(page)
    elif job.state == "done" and clean and clean.exists():
        show(clean, image_editor(bpy.context))


CLASSES = (
    POLYRECON_OT_set_up_passes,
    POLYRECON_OT_denoise,
    POLYRECON_OT_render,
    POLYRECON_OT_adaptive,
    POLYRECON_OT_frames,
    POLYRECON_OT_cancel,
    POLYRECON_OT_preferences,
    POLYRECON_OT_show,
    POLYRECON_OT_compare,
    POLYRECON_OT_compositor,
)
