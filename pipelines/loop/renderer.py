"""What the loop asks of a renderer. A renderer is one file with a subclass of Renderer; nothing else in the loop knows it.

The terms:
  sequence  The samples of a pixel, numbered from 0. Sample s of a pixel is always the same one, whichever pass draws it, so
            the loop never asks for a number twice. A renderer without a sequence may use `first` as its seed, if different
            numbers give independent samples.
  part      One EXR of one pass over the whole frame, of any layout that `polyrecon merge` reads, the layers being the same
            in all parts of a frame (further layers, in the first part only, are kept as they are). Channels of every part,
            after the view layer's prefix where there is one (`ViewLayer.Sample Count.X`):
              Sample Count.X    how many samples each pixel is the mean of; 0 where the pass has none, whatever the values
              Render Seconds.X  optional: the time that these samples took, in any unit. It tells the loop what a sample
                                of each pixel costs.
"""

import abc
import dataclasses
import pathlib
from typing import Optional

import numpy as np

SAMPLE_COUNT = "Sample Count.X"
RENDER_SECONDS = "Render Seconds.X"


@dataclasses.dataclass
class Switch:
    """Something that was switched off, or on, for the loop, since it cannot change the image or would spoil the samples."""

    effect: str  # "motion blur"
    setting: str  # "off"
    reason: str  # "nothing moves within the shutter"
    saves: str = ""  # "one synchronisation a pass"


@dataclasses.dataclass
class Audit:
    """What the frame calls for."""

    width: int
    height: int
    beauty: str = ""  # layer of the picture in the parts, "ViewLayer.Combined"; "": bare R, G, B
    switches: list[Switch] = dataclasses.field(default_factory=list)  # printed, and a table of the report
    passes: dict[str, str] = dataclasses.field(default_factory=dict)  # pass asked for -> why
    notes: list[str] = dataclasses.field(default_factory=list)  # lines for the user
    method: str = ""  # how extra samples are rendered, in a few words


class Renderer(abc.ABC):
    """One scene. Failures are raised as DriverError(ExitCode.RENDERER, one line); the driver can then be resumed."""

    name = ""  # "Blender 5.0.1": for the report
    last_over_round = 0.0  # seconds of complete_last over those of judging a round: kept back from a budget of seconds

    @abc.abstractmethod
    def begin(self, frame: Optional[int]) -> Audit:
        """Opens a frame (None: the scene's own) and says what it calls for. Called once before the passes of a frame."""

    @abc.abstractmethod
    def uniform(self, first: int, samples: int, target: pathlib.Path) -> None:
        """Renders samples first .. first + samples - 1 of every pixel and writes them as a part.

        The first part of a frame may hold further layers that the user asked for."""

    @abc.abstractmethod
    def extra(self, first: int, counts: np.ndarray, target: pathlib.Path) -> int:
        """Renders counts[y, x] samples of each pixel (integers, 0 or a power of two, row 0 at the top) and writes them as ONE
        part. Uses numbers of the sequence from `first` on, as many as it likes; returns how many.

        A renderer that cannot sample single pixels may take more than it is asked for; `Sample Count.X` says what was
        taken, and must not depend on the values of the samples, else the picture would be biased."""

    def complete(self, merged: pathlib.Path) -> None:
        """Adds to a file of merged parts what is rendered once and for all, feature passes for instance. They must not
        depend on the samples of the picture."""

    def complete_last(self, merged: pathlib.Path) -> None:
        """Adds to the merged file of all parts what serves the last reconstruction alone: a prior made from its halves."""

    def close(self) -> None:
        """Ends what runs in the background. Called once, in every case."""
