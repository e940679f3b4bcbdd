"""The settings of the panel, which are stored in the scene."""

import pathlib

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from .programs import SetupError

# Blender 4.5 and later: the path may begin with "//".
_RELATIVE = {"options": {"PATH_SUPPORTS_BLEND_RELATIVE"}} if bpy.app.version >= (4, 5) else {}
PARTS = 8  # of a render with an error estimate


class PolyreconSettings(bpy.types.PropertyGroup):
    output: StringProperty(
        name="Output",
        subtype="FILE_PATH",
        default="//polyrecon/clean_####.exr",
        description="Clean EXR to write; #### becomes the frame number. Noisy picture and error map are put next to it",
        **_RELATIVE,
    )
    quality: EnumProperty(
        name="Quality",
        default="standard",
        items=(
            ("draft", "Draft", "For previews: the fastest"),
            ("standard", "Standard", "For final pictures"),
            ("best", "Best", "The most accurate, and the slowest"),
        ),
    )
    second_opinion: BoolProperty(
        name="Ask Open Image Denoise",
        default=True,
        description="A second opinion: its picture is used where it is better. With few samples it makes the largest "
        "difference",
    )
    light_passes: BoolProperty(
        name="Denoise Light Passes",
        description="Denoise the light passes and light groups too, so that they still add up to the picture. "
        "Off: they stay noisy",
    )
    limit: EnumProperty(
        name="Stop",
        default="SECONDS",
        items=(
            ("SECONDS", "Time", "Stop after this much time, everything included"),
            ("SPP", "Samples", "Stop after this many samples per pixel, on average"),
            ("TARGET", "Noise", "Stop when so little noise is left"),
        ),
    )
    seconds: FloatProperty(
        name="Seconds", default=120, min=1, soft_max=3600, precision=0, description="Time for all frames together"
    )
    spp: IntProperty(
        name="Samples", default=64, min=1, soft_max=4096, description="Average samples per pixel of all frames"
    )
    target: FloatProperty(
        name="Noise",
        default=0.002,
        min=1e-6,
        soft_max=0.1,
        precision=4,
        description="Noise that may be left: the mean of its square, relative to the brightness, over all frames. "
        "0.01 is a preview, 0.002 is clean, 0.0005 is very clean",
    )
    frames: EnumProperty(
        name="Render",
        default="CURRENT",
        items=(
            ("CURRENT", "This Frame", "The current frame"),
            ("RANGE", "All Frames", "The scene's frame range with its step"),
        ),
    )
    resume: BoolProperty(
        name="Add to the Last Run",
        description="Add samples to the last adaptive render, with the scene as it was then",
    )
    folder: StringProperty(
        name="Folder",
        subtype="DIR_PATH",
        description="Folder with renders: all EXR files in it are denoised into the folder 'denoised' in there",
        **_RELATIVE,
    )

    def frames_of(self, scene):
        if self.frames == "CURRENT":
            return [scene.frame_current]
        return list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))

    def frames_words(self, scene):
        """The drivers' option for the frames."""
        if self.frames == "CURRENT":
            return [f"--frame={scene.frame_current}"]
        return [f"--frames={scene.frame_start}-{scene.frame_end}x{scene.frame_step}"]

    def limit_words(self):
        """The driver's options for the limit."""
        return {
            "SECONDS": ["--budget-seconds", f"{self.seconds:g}"],
            "SPP": ["--budget-spp", str(self.spp)],
            "TARGET": ["--target", f"{self.target:g}"],
        }[self.limit]

    def output_pattern(self):
        """The output as an absolute path, with the place of the frame's number."""
        path = absolute(self.output, "output")
        if path.suffix.lower() != ".exr":
            raise SetupError(f"{path.name}: the output must be an .exr file")
        return path

    def output_of(self, frame):
        """The output of one frame."""
        from polyrecon_pipelines.common import frame_names

        pattern = self.output_pattern()
        return pathlib.Path(frame_names.frame_path(pattern, frame)) if frame_names.is_pattern(pattern) else pattern

    def passes(self, scene):
        """The folders of the passes that the drivers make for these frames."""
        from polyrecon_pipelines.common import frame_names

        if self.frames == "CURRENT":
            return [output.with_suffix(".passes") for output in self.outputs(scene).values()]
        folder = frame_names.passes_of_all(self.output_pattern())
        return [frame_names.passes_of_frame(folder, frame) for frame in self.frames_of(scene)]

    def outputs(self, scene):
        """{frame: output} of the frames to render."""
        found = {frame: self.output_of(frame) for frame in self.frames_of(scene)}
        if len(set(found.values())) < len(found):
            raise SetupError(f"{self.output}: several frames need #### in the file's name")
        return found


def absolute(path, what):
    """A path of the settings as an absolute path. what: its name in messages."""
    if path.startswith("//") and not bpy.data.filepath:
        raise SetupError(f"the {what} is relative to the .blend file: save that first, or give an absolute path")
    return pathlib.Path(bpy.path.abspath(path))


CLASSES = (PolyreconSettings,)
