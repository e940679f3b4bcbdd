"""The settings of the panel, which are stored in the scene."""

import pathlib
import re

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from .programs import SetupError

# Blender 4.5 and later: the path may begin with "//".
_RELATIVE = {"options": {"PATH_SUPPORTS_BLEND_RELATIVE"}} if bpy.app.version >= (4, 5) else {}
_PLACE = re.compile(r"#+|%(?:0[1-9])?d")


def frame_path(pattern, frame):
    """The pattern with the frame's number in its place. The drivers have the same rules in common/frame_names.py, which
    Blender cannot import where the add-on is installed alone."""
    places = _PLACE.findall(pattern.rpartition("/")[2])
    if not places:
        return pattern
    place = places[-1]
    number = place % frame if place.startswith("%") else f"{'-' if frame < 0 else ''}{abs(frame):0{len(place)}d}"
    return _PLACE.sub(lambda match: number if match.group() == place else match.group(), pattern)


class PolyreconSettings(bpy.types.PropertyGroup):
    output: StringProperty(
        name="Output",
        subtype="FILE_PATH",
        default="//polyrecon/clean_####.exr",
        description="Clean EXR to write; #### becomes the frame number. Noisy picture and error map are put next to it",
        **_RELATIVE,
    )
    limit: EnumProperty(
        name="Limit",
        default="SECONDS",
        items=(
            ("SECONDS", "Time", "Stop after this much time, everything included"),
            ("SPP", "Samples", "Stop after this many samples per pixel, on average"),
            ("TARGET", "Error", "Stop when the estimated error is this small"),
        ),
    )
    seconds: FloatProperty(
        name="Seconds", default=120, min=1, soft_max=3600, precision=0, description="Time for all frames together"
    )
    spp: IntProperty(
        name="Samples", default=64, min=1, soft_max=4096, description="Average samples per pixel of all frames"
    )
    target: FloatProperty(
        name="Error",
        default=0.002,
        min=1e-6,
        soft_max=0.1,
        precision=4,
        description="Relative squared error to reach, the mean of all frames",
    )
    frames: EnumProperty(
        name="Frames",
        default="CURRENT",
        items=(
            ("CURRENT", "Current", "The current frame"),
            ("RANGE", "Range", "The scene's frame range with its step"),
        ),
    )
    resume: BoolProperty(
        name="Continue",
        description="Add samples to the last adaptive render, with the scene as it was then",
    )

    def frames_of(self, scene):
        if self.frames == "CURRENT":
            return [scene.frame_current]
        return list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))

    def frames_words(self, scene):
        """The driver's option for the frames."""
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
        if self.output.startswith("//") and not bpy.data.filepath:
            raise SetupError("the output is relative to the .blend file: save that first, or give an absolute path")
        path = pathlib.Path(bpy.path.abspath(self.output))
        if path.suffix.lower() != ".exr":
            raise SetupError(f"{path.name}: the output must be an .exr file")
        return path

    def output_of(self, frame):
        """The output of one frame."""
        return pathlib.Path(frame_path(str(self.output_pattern()), frame))


CLASSES = (PolyreconSettings,)
