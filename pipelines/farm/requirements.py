"""What a frame asks of a machine: memory and seconds, by a model whose constants are measured.

The constants are in model.json, and tests/bench/farm_model.py is the command that measures them.
"""

import json
import math
import pathlib
from dataclasses import dataclass

from ..common.errors import DriverError, ExitCode

MODEL_FILE = pathlib.Path(__file__).with_name("model.json")
MEMORY_MARGIN = 1.15  # of what is asked for over what the model says
MIB = 1 << 20
AOV_BYTES = 24  # of a neighbour's pixel: two halves of three floats
DEFAULT_RADIUS = 2  # of `polyrecon denoise --frame-radius`
# The passes that take part in the fit; other channels are only copied.
ROLES_OF_THE_FIT = ("beauty", "normal", "albedo", "depth", "visibility", "prior", "alpha")


@dataclass(frozen=True)
class Frame:
    """Of one input file: pixels of its data window, channels in all, and channels that take part in the fit."""

    width: int
    height: int
    channels: int
    fit_channels: int

    @property
    def pixels(self):
        return self.width * self.height


@dataclass(frozen=True)
class Node:
    """One kind of machine: processors, and bytes of memory (0: the engine does not know)."""

    cpus: int
    memory: int


def frame_of(inspection):
    """A Frame out of what `polyrecon inspect --json` prints."""
    parts = [part for part in inspection["files"][0]["parts"] if part["readable"]]
    window = max((part["data_window"] for part in parts), key=lambda w: w["width"] * w["height"])
    fit_layers = {role["layer"] for role in inspection["roles"] if role["role"] in ROLES_OF_THE_FIT}
    fit = sum(len(layer["channels"]) for layer in inspection["layers"] if layer["name"] in fit_layers)
    return Frame(window["width"], window["height"], sum(len(part["channels"]) for part in parts), fit)


class Model:
    def __init__(self, path=MODEL_FILE):
        try:
            constants = json.loads(pathlib.Path(path).read_text())
            self.memory, self.seconds = constants["memory"], constants["seconds"]
            self.neighbour = constants["neighbour"]
            self.parallel_part = constants["parallel_part"]
        except OSError as error:
            raise DriverError(ExitCode.MISSING, f"{path}: {error.strerror}") from error
        except (ValueError, KeyError) as error:
            raise DriverError(ExitCode.BAD_INPUT, f"{path}: no model of farm_model.py ({error})") from error

    def peak_bytes(self, frame, quality, aovs=0, radius=DEFAULT_RADIUS):
        """Largest resident size of `polyrecon denoise` on a sequence (the next frame is read meanwhile), no tiles."""
        m = self.memory
        per_pixel = m["per_pixel"][quality] + m["per_fit_channel"] * (frame.fit_channels + 3 * aovs)
        held = 2 * radius + 2 if radius else 0  # neighbours, with those of the next frame
        per_pixel += held * (self.neighbour["bytes"] + AOV_BYTES * aovs)
        return m["base"] + frame.pixels * (per_pixel + m["per_channel"] * frame.channels)

    def request_bytes(self, frame, quality, aovs=0, radius=DEFAULT_RADIUS):
        """What to ask an engine for: with margin, whole MiB."""
        return math.ceil(MEMORY_MARGIN * self.peak_bytes(frame, quality, aovs, radius) / MIB) * MIB

    def cpu_seconds(self, frame, quality, radius=DEFAULT_RADIUS):
        """Of all threads, for one frame, on a machine like the one that was measured."""
        s = self.seconds
        per_pixel = s["per_pixel"][quality] + s["per_channel"] * frame.channels + self.neighbour["seconds"] * 2 * radius
        return s["start"] + frame.pixels * per_pixel

    def wall_seconds(self, frame, quality, threads, radius=DEFAULT_RADIUS):
        """Amdahl's law with the measured parallel part."""
        return self.cpu_seconds(frame, quality, radius) * (1 - self.parallel_part + self.parallel_part / threads)


def threads_for(memory, nodes):
    """Threads of one task, so that tasks use up the processors of a node no later than its memory.

    Frames do not depend on each other, so a node does most with as many tasks of few threads as its memory holds.
    """
    known = [node for node in nodes if node.memory]
    fitting = [node for node in known if node.memory >= memory]
    if known and not fitting:
        most = max(node.memory for node in known)
        raise DriverError(
            ExitCode.MEMORY,
            f"a frame needs {memory / 1e9:.1f} GB, the largest node has {most / 1e9:.1f} GB: "
            "give --memory, the frame is then worked in tiles",
        )
    return max((math.ceil(node.cpus / (node.memory // memory)) for node in fitting), default=1)


def chunk_for(seconds_a_frame, task_minutes, frames, most_tasks):
    """Frames of one task: about task_minutes of work, and no more tasks than the engine takes."""
    by_time = int(60 * task_minutes / max(seconds_a_frame, 1e-3))
    return max(1, min(by_time, frames), math.ceil(frames / most_tasks))
