"""Memory and seconds of a frame, by a model with measured constants, and the threads and chunks of a task.

The constants are in model.json; tests/bench/farm_model.py measures them.
"""

import errno
import math
import os
import pathlib
from dataclasses import dataclass
from typing import Any

from ..common.decode import InvalidFileError, decode, read_json
from ..common.denoise_defaults import DEFAULT_FRAME_RADIUS, QUALITIES
from ..common.errors import DriverError, ExitCode

MODEL_FILE = pathlib.Path(__file__).with_name("model.json")
MEMORY_MARGIN = 1.15  # requested memory over that of the model
MIB = 1 << 20


@dataclass(frozen=True)
class Frame:
    """The size of an input file."""

    width: int  # of the data window
    height: int
    channels: int  # of all layers
    fit_channels: int  # of the layers that take part in the fit, without those of --aov
    aovs: int = 0  # layers of --aov

    @property
    def pixels(self):
        return self.width * self.height


@dataclass(frozen=True)
class Node:
    """A kind of machine."""

    cpus: int
    memory: int  # bytes; 0 if the engine does not know


def frame_of(inspection):
    """The Frame of what `polyrecon inspect --json` prints."""
    parts = [part for part in inspection["files"][0]["parts"] if part["readable"]]
    window = max((part["data_window"] for part in parts), key=lambda w: w["width"] * w["height"])
    fit_layers = {role["layer"] for role in inspection["roles"] if role["in_fit"] and role["role"] != "color"}
    aovs = sum(role["role"] == "color" and role["holds"] == "mean" for role in inspection["roles"])
    fit = sum(len(layer["channels"]) for layer in inspection["layers"] if layer["name"] in fit_layers)
    return Frame(window["width"], window["height"], sum(len(part["channels"]) for part in parts), fit, aovs)


@dataclass(frozen=True)
class Constants:
    """What farm_model.py writes."""

    made_by: str
    memory: dict[str, Any]  # "per_pixel" has a number for each quality, the others are numbers.
    seconds: dict[str, Any]
    neighbour: dict[str, float]
    parallel_part: float


class Model:
    def __init__(self, path=MODEL_FILE):
        if not os.path.exists(path):
            raise DriverError(ExitCode.MISSING, f"{path}: {os.strerror(errno.ENOENT)}")
        try:
            constants = decode(Constants, read_json(path))
            self.memory = _numbers(constants.memory, ("base", "per_fit_channel", "per_channel"))
            self.seconds = _numbers(constants.seconds, ("start", "per_channel"))
            self.neighbour, self.parallel_part = constants.neighbour, constants.parallel_part
            if not self.memory["base"] > 0 or not self.seconds["start"] > 0:
                raise InvalidFileError("base or start is not above 0")
            if self.neighbour.keys() != {"bytes", "bytes_per_aov", "seconds"} or self.parallel_part > 1:
                raise InvalidFileError("neighbour has other keys, or parallel_part is above 1")
        except InvalidFileError as error:
            raise DriverError(
                ExitCode.BAD_INPUT, f"{path}: is not a file that farm_model.py writes ({error})"
            ) from error

    def peak_bytes(self, frame, quality, aovs=0, radius=DEFAULT_FRAME_RADIUS):
        """Largest resident size of `polyrecon denoise` on a sequence, with the next frame, and without tiles."""
        m = self.memory
        per_pixel = m["per_pixel"][quality] + m["per_fit_channel"] * (frame.fit_channels + 3 * aovs)
        held = 2 * radius + 2 if radius else 0  # neighbours of this frame and of the next one
        per_pixel += held * (self.neighbour["bytes"] + self.neighbour["bytes_per_aov"] * aovs)
        return m["base"] + frame.pixels * (per_pixel + m["per_channel"] * frame.channels)

    def request_bytes(self, frame, quality, aovs=0, radius=DEFAULT_FRAME_RADIUS):
        """The memory to request from an engine: peak_bytes with a margin, in whole MiB."""
        return math.ceil(MEMORY_MARGIN * self.peak_bytes(frame, quality, aovs, radius) / MIB) * MIB

    def cpu_seconds(self, frame, quality, radius=DEFAULT_FRAME_RADIUS):
        """Processor seconds of one frame, of all threads, on a machine like the measured one."""
        s = self.seconds
        per_pixel = s["per_pixel"][quality] + s["per_channel"] * frame.channels + self.neighbour["seconds"] * 2 * radius
        return s["start"] + frame.pixels * per_pixel

    def wall_seconds(self, frame, quality, threads, radius=DEFAULT_FRAME_RADIUS):
        """Seconds of one frame by Amdahl's law with the measured parallel part."""
        return self.cpu_seconds(frame, quality, radius) * (1 - self.parallel_part + self.parallel_part / threads)


def _numbers(values, names):
    """The values, checked: a number of each name, and one for each quality."""
    if values.keys() != {"per_pixel", *names}:
        raise InvalidFileError(f"there are {', '.join(values)} in place of per_pixel, {', '.join(names)}")
    decode(dict[str, float], {name: values[name] for name in names})
    if decode(dict[str, float], values["per_pixel"], "per_pixel").keys() != set(QUALITIES):
        raise InvalidFileError("per_pixel is not of all qualities")
    return values


def threads_for(memory, nodes):
    """Threads of a task of so many bytes, so that the tasks that fill a node's memory use all its processors.

    Frames do not depend on each other, so many tasks with few threads finish most frames per hour.
    """
    known = [node for node in nodes if node.memory]
    fitting = [node for node in known if node.memory >= memory]
    if known and not fitting:
        most = max(node.memory for node in known)
        raise DriverError(
            ExitCode.MEMORY,
            f"a task of {memory / 1e9:.1f} GB fits on no node, the largest has {most / 1e9:.1f} GB: "
            f"--memory {most // MIB}M denoises frames in tiles",
        )
    return max((math.ceil(node.cpus / (node.memory // memory)) for node in fitting), default=1)


def chunk_for(seconds_a_frame, task_minutes, frames, max_tasks):
    """Frames of a task: about task_minutes of work, and as many as make max_tasks tasks at most."""
    by_time = 60 * task_minutes / max(seconds_a_frame, 1e-3)
    return max(1, int(min(by_time, frames)), math.ceil(frames / max_tasks))
