"""Runs inside Blender: opens a file and renders passes of it in one process, as the driver requests.

    blender -b -Y --factory-startup --python-exit-code 7 -P session.py      with Blender itself
    python3 session.py                                                      with the module bpy

It reads jobs from standard input, one JSON object a line, and answers each with a line on standard output that begins
with MARK. What Blender prints goes to standard error, since names in a file can hold such lines too. No script of the
file runs, because of -Y and use_scripts=False."""

import contextlib
import json
import os
import sys
import time
import traceback

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
if not sys.dont_write_bytecode:  # A checkout stays as it is.
    sys.dont_write_bytecode = True

import audit
import caches
import camera
import device as devices
import inputs

MARK = "@polyrecon "
# Samples of one sequence; further ones have other seeds. Cycles lays out a table for a whole sequence, and where that
# is too long for the processor's caches a sample takes up to a tenth longer (docs/lab/2026-11-27-loop-seconds.md).
SEQUENCE = 1 << 8
LONGEST_SEQUENCE = 1 << 13  # of Cycles; later samples are spread less well
MAX_SEED = (1 << 31) - 1


class Session:
    def __init__(self):
        self.scene = self.view_layer = self.mask_camera = None

    def open(self, path, frame, visibility, view_layer, device, mask_camera, cache_folder, shot):
        """Opens the file, if it is not open, at a frame, sets it up, and returns what it is. Nothing is ever saved.

        device: "cpu", "gpu" or "auto". cache_folder: where simulations write; None if they cannot be kept from writing
        elsewhere. shot: whether frames before and after will join, so that each frame needs a seed of its own."""
        if self.scene is None:
            self.load(path, visibility, view_layer, device, cache_folder)
        scene = self.scene
        scene.cycles.use_animated_seed = shot or self.file_animates_seed
        self.go_to(self.file_frame if frame is None else frame)
        if scene.camera is None:
            raise RuntimeError("the scene has no camera")
        if self.mask_camera:
            self.mask_camera.use(None)  # Frames may have different cameras.
        reason = "rectangles were requested"
        if mask_camera:
            reason = camera.why_not(scene, scene.camera, bpy.context.evaluated_depsgraph_get(), self.device)
        self.mask_camera = None if reason else camera.MaskCamera(scene)
        scale = scene.render.resolution_percentage / 100
        return {
            "width": int(scene.render.resolution_x * scale),
            "height": int(scene.render.resolution_y * scale),
            "frame": scene.frame_current,
            "view_layer": self.view_layer.name,
            "version": bpy.app.version_string,
            "effects": self.effects,
            "switches": self.switches,
            "motion_blur": bool(scene.render.use_motion_blur),
            "user_passes": [name for _, name in self.user_passes if name != "use_pass_combined"],
            "device": self.device,
            "scene_device": self.scene_device,
            "no_mask_camera": reason,
            "denoising_data": self.denoising_data,
            "path_guiding": bool(getattr(scene.cycles, "use_guiding", False)),
            "output": self.output,
            "sequence": self.sequence,
            "samples": self.file_samples,
            "filter_overhang": camera.filter_overhang(scene),
            "files": self.files,
        }

    def load(self, path, visibility, view_layer, device, cache_folder):
        try:
            bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
        except RuntimeError as error:
            refuse_newer(path, inputs.version_of(path))
            this = ".".join(map(str, bpy.app.version[:2]))
            raise RuntimeError(f"{error}".strip() + f" (or one of a Blender later than {this})") from error
        refuse_newer(path, bpy.data.version)
        self.files = {"opened": inputs.opened(bpy.data.filepath), "used": inputs.used()}
        if cache_folder:
            caches.redirect(cache_folder)
        scene = self.scene = bpy.context.scene
        if scene.render.engine != "CYCLES":
            raise RuntimeError(f"the scene's renderer is {scene.render.engine}, not Cycles")
        self.file_frame, self.file_seed = scene.frame_current, scene.cycles.seed
        self.file_animates_seed, self.file_samples = scene.cycles.use_animated_seed, scene.cycles.samples
        self.view_layer = self.choose_view_layer(view_layer)
        self.scene_device = scene.cycles.device
        self.device = devices.choose(scene, device)
        self.effects = audit.effects(scene, self.view_layer)
        self.switches = audit.switch_off(scene, self.view_layer, is_chosen=view_layer is not None)
        self.output = self.output_of(scene.render.image_settings)
        self.choose_output(scene.render)
        self.user_passes = self.passes_on()
        self.user_requests_vectors = any(name == "use_pass_vector" for _, name in self.user_passes)
        self.denoising_data = bool(self.view_layer.cycles.denoising_store_passes)
        self.choose_passes(visibility)
        scene.render.use_persistent_data = True

    def choose_view_layer(self, name):
        """The view layer of this name; without one, the first that is switched on."""
        layers = self.scene.view_layers
        if name is None:
            return next((layer for layer in layers if layer.use), layers[0])
        if name not in layers:
            raise RuntimeError(f"the scene has no view layer {name!r}; it has {', '.join(map(repr, layers.keys()))}")
        layers[name].use = True
        return layers[name]

    def go_to(self, frame):
        """Evaluates the scene at a frame. If the seed is animated, each render resets it; then there is one sequence
        only."""
        cycles = self.scene.cycles
        cycles.seed = probe = self.file_seed ^ 0x2A5F31C7
        self.scene.frame_set(frame)
        self.sequence = SEQUENCE if cycles.seed == probe else None
        if self.sequence:
            cycles.seed = self.file_seed

    def output_of(self, settings):
        """The format of the scene's output: whether pictures are 32-bit floats, and their compression."""
        if not settings.file_format.startswith("OPEN_EXR"):
            return {"float": False, "compression": "zip"}
        return {"float": settings.color_depth == "32", "compression": settings.exr_codec.lower()}

    def choose_output(self, render):
        settings = render.image_settings
        if hasattr(settings, "media_type"):  # Blender 5
            settings.media_type = "MULTI_LAYER_IMAGE"
            settings.use_exr_interleave = True
        settings.file_format = "OPEN_EXR_MULTILAYER"
        settings.color_depth = "32"
        settings.exr_codec = "NONE"  # The driver reads the file once and deletes it.
        render.use_file_extension = False
        render.use_overwrite = True
        render.use_placeholder = False

    def passes_on(self):
        """The passes that are switched on: [(owner, property)]."""
        return [
            (owner, p.identifier)
            for owner in (self.view_layer, self.view_layer.cycles)
            for p in owner.bl_rna.properties
            if p.identifier.startswith(("use_pass_", "pass_debug_", "pass_render_"))
            and p.type == "BOOLEAN"
            and not p.is_readonly
            and getattr(owner, p.identifier)
        ]

    def choose_passes(self, visibility):
        """Switches on the passes of every part: picture, features, seconds."""
        for owner, name in self.user_passes:
            setattr(owner, name, False)
        layer = self.view_layer
        wanted = {"shadow": "use_pass_shadow", "ambient-occlusion": "use_pass_ambient_occlusion"}.get(visibility)
        if wanted and not hasattr(layer, wanted):
            raise RuntimeError(f"Blender {bpy.app.version_string} has no pass {visibility}")
        for owner, name in (
            (layer, "use_pass_combined"),
            (layer.cycles, "denoising_store_passes"),
            (layer, wanted),
            (layer.cycles, "pass_render_time"),
        ):
            if name and hasattr(owner, name):
                setattr(owner, name, True)
        self.part_passes = self.passes_on()

    def render(self, target, first, samples, crop=None, mask=None, user_passes=False, vectors=False):
        """Renders samples first .. first + samples - 1, which are of one sequence, to an EXR file.

        crop: [x0, y0, x1, y1] in pixels from the top left, end excluded. mask: see camera.py. user_passes: whether the
        passes that the user switched on are rendered too. vectors: whether the motion vectors are."""
        scene = self.scene
        for owner, name in self.user_passes:
            setattr(owner, name, user_passes or (owner, name) in self.part_passes)
        if vectors or not self.user_requests_vectors:
            self.view_layer.use_pass_vector = vectors
        self.choose_samples(first, samples)
        self.choose_crop(crop)
        if self.mask_camera:
            self.mask_camera.use(mask)
        scene.render.filepath = target
        begin = time.monotonic()
        with self.no_motion_blur() if vectors else contextlib.nullcontext():
            bpy.ops.render.render(write_still=True, scene=scene.name)
        return {"seconds": time.monotonic() - begin}

    @contextlib.contextmanager
    def no_motion_blur(self):
        """Cycles writes no motion vectors of a picture with motion blur."""
        render = self.scene.render
        blurs, render.use_motion_blur = render.use_motion_blur, False
        try:
            yield
        finally:
            render.use_motion_blur = blurs

    def choose_samples(self, first, samples):
        cycles = self.scene.cycles
        if self.sequence:
            number, first = divmod(first, self.sequence)
            cycles.seed = (self.file_seed + number) & MAX_SEED
        if hasattr(cycles, "use_sample_subset"):  # Blender 5
            cycles.samples = max(self.sequence or LONGEST_SEQUENCE, first + samples)
            cycles.use_sample_subset = True
            cycles.sample_offset = first
            cycles.sample_subset_length = samples
        else:
            cycles.samples = samples
            cycles.sample_offset = first

    def choose_crop(self, crop):
        render = self.scene.render
        render.use_border = render.use_crop_to_border = crop is not None
        if crop:
            scale = render.resolution_percentage / 100
            width, height = int(render.resolution_x * scale), int(render.resolution_y * scale)
            x0, y0, x1, y1 = crop
            # Borders lie inside a pixel, so that rounding does not select the one before it.
            render.border_min_x, render.border_max_x = (x0 + 0.1) / width, (x1 + 0.1) / width
            render.border_min_y, render.border_max_y = (height - y1 + 0.1) / height, (height - y0 + 0.1) / height


def refuse_newer(path, version):
    """Refuses a file of a newer Blender: this one would leave out what it does not know. version: None if unknown."""
    if version and tuple(version[:2]) > bpy.app.version[:2]:
        saved, this = (".".join(map(str, numbers[:2])) for numbers in (version, bpy.app.version))
        raise RuntimeError(f"{path} was saved by Blender {saved}, this is {this}: name {saved} or later with --blender")


def take_standard_output():
    """The stream of answers: standard output as it was. For everyone else it is standard error from now on."""
    sys.stdout.flush()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return answers


def main():
    session, answers = Session(), take_standard_output()
    for line in sys.stdin:
        job = json.loads(line)
        try:
            answer = getattr(session, job.pop("do"))(**job)
        except Exception as error:  # The driver decides what to do.
            traceback.print_exc()
            answer = {"error": f"{error}".strip().replace("\n", " ") or type(error).__name__}
        print(f"\n{MARK}{json.dumps(answer)}", file=answers, flush=True)


main()
