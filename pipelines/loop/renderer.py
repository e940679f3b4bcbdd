"""The interface between the loop and a renderer. A new renderer is one file with a subclass of Renderer.

Terms:
  sequence  The samples of a pixel, numbered from 0. Sample s of a pixel is the same one in every pass, and the loop
            never requests a number twice. A renderer that has only a seed takes `first` for it. Different seeds must
            give independent samples, and so must two rectangles of one part, which have the same seed.
  part      One EXR file with samples of the whole frame, in any layout that `polyrecon merge` reads. All parts of a
            frame have the same layers; the first part may have more, which are kept as they are. Every part has these
            channels, after the prefix of the view layer if there is one (`ViewLayer.Sample Count.X`):
              Sample Count.X    How many samples each pixel is the mean of. Where it is 0, the pixel's other values are
                                ignored.
              Render Seconds.X  Optional: the time that these samples took, in any unit. The loop derives from it
                                what a sample of each pixel costs.
"""

import abc
import dataclasses
import pathlib
from typing import Optional

import numpy as np

from ..common.layer_names import SAMPLE_COUNT_PASS

SAMPLE_COUNT = f"{SAMPLE_COUNT_PASS}.X"
RENDER_SECONDS = "Render Seconds.X"


@dataclasses.dataclass(frozen=True)
class Switch:
    """A setting of the scene that the loop changes: it cannot affect the picture, or it would spoil the samples."""

    effect: str  # "motion blur"
    setting: str  # "off"
    reason: str  # "nothing moves within the shutter"
    saves: str = ""  # "one synchronisation a pass"
    changes_picture: bool = False  # The result lacks what the scene requests.

    def __str__(self):
        return f"{self.effect} {self.setting}: {self.reason}"


@dataclasses.dataclass
class Audit:
    """Describes and renders one frame."""

    width: int
    height: int
    beauty: str = ""  # Layer of the picture in the parts, "ViewLayer.Combined"; "": bare R, G, B
    switches: list[Switch] = dataclasses.field(default_factory=list)  # Printed, and a table of the report
    passes: dict[str, str] = dataclasses.field(default_factory=dict)  # Name of each pass, and why it is rendered
    notes: list[str] = dataclasses.field(default_factory=list)  # Printed before any rendering
    details: list[str] = dataclasses.field(default_factory=list)  # Printed with --verbose
    method: str = ""  # How extra samples are rendered, in a few words
    features: list[str] = dataclasses.field(default_factory=list)  # The passes that guide the result: "albedo"
    working: list[str] = dataclasses.field(default_factory=list)  # Layers of the parts that the user did not request
    float_colours: bool = False  # Whether the scene requests a picture of 32-bit floats
    compression: str = "zip"  # The picture's: that of the scene's own output, in OpenImageIO's words
    inputs: dict[str, str] = dataclasses.field(
        default_factory=dict
    )  # SHA-256 of each file that the picture shows; none: that of the scene is compared

    def __post_init__(self):
        self.notes += [str(switch) for switch in self.switches if switch.changes_picture]

    def lines(self):
        """Lines about changes and decisions, for the terminal."""
        found = [f"{switch} (saves {switch.saves})" if switch.saves else str(switch) for switch in self.switches]
        return [*found, f"extra samples: {self.method}", *self.details]


class Renderer(abc.ABC):
    """Renders the frames of one scene. Failures are raised as DriverError(ExitCode.RENDERER, one line); the frame can
    then be resumed."""

    name = ""  # Name and version for the report: "Blender 5.0.1"

    # Whether `extra` takes its samples from the sequence. If not, the renderer itself sees to it that no pixel takes a
    # sample twice, and may take more than the largest count.
    extra_in_sequence = True

    # Whether frames before and after join in the reconstruction. Then the samples of different frames must be
    # independent, as far as the renderer has seeds, and the first part of a frame holds its motion vectors, as far as
    # the renderer has them. Set before the first frame.
    shot = False

    completes = False  # Whether `complete` or `add_own_passes` adds anything.

    @abc.abstractmethod
    def begin(self, frame: Optional[int]) -> Audit:
        """Opens a frame; None is the scene's current frame. Called before the passes of a frame.

        The frames of a shot take turns, so a frame may be opened again. Its samples and features must be the same as
        before."""

    @abc.abstractmethod
    def uniform(self, first: int, samples: int, target: pathlib.Path) -> None:
        """Renders samples first .. first + samples - 1 of every pixel and writes them as a part.

        The first part of a frame may hold further layers that the user switched on."""

    @abc.abstractmethod
    def extra(self, first: int, counts: np.ndarray, target: pathlib.Path) -> None:
        """Renders counts[y, x] samples of each pixel and writes them as one part. Row 0 is at the top. The counts are
        whole numbers, not all 0: the same one everywhere, or 0 and powers of two.

        Takes the numbers first .. first + max(counts) - 1 and no others: those behind are the other half's. A pixel
        with n samples takes the first n of them.

        A renderer that cannot sample single pixels may take other counts than requested, at least one sample and about
        as many in all. `Sample Count.X` says what was taken. It must not depend on the values of the samples, or the
        picture is biased."""

    def complete(self, merged: pathlib.Path) -> None:  # noqa: B027 (optional)
        """Adds to a file of merged parts what is rendered once for the frame, such as feature passes. They must not
        depend on the samples of the picture."""

    def add_own_passes(self, merged: pathlib.Path) -> None:  # noqa: B027 (optional)
        """Puts passes that only the user needs into the file of all parts. Called once for a result, so they may have
        samples of their own."""

    def close(self) -> None:  # noqa: B027 (optional)
        """Ends processes in the background. Called once, also after an error."""
