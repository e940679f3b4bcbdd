"""A frame of a shot: the steps that a frame by itself does not take."""

import dataclasses
import math
import time

from .frame import FrameLoop
from .journal import HALVES, Round


class ShotFrame(FrameLoop):
    """A frame of a shot. While the shot works on it, its clock runs and its sums are in memory."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.journal.stop_clock()
        self.rendering = None
        self.noise, self.noise_samples = math.nan, 0.0  # Reconstruction.noise, and the samples per pixel that it is of
        self.has_ended = False  # Whether no error is left, or no round that is large enough.
        number = len(self.state.rounds) - 1
        if self.error_is_known and not all(self.folder.in_round(number, f"error_{half}").exists() for half in HALVES):
            self.state.rounds.pop()

    def announce(self, phase, **figures):
        self.on_announce(self, phase, **figures)

    @property
    def error_is_known(self):
        """Whether the last decision knows all samples, and no round has followed it."""
        rounds = self.state.rounds
        return bool(rounds) and not rounds[-1].next_samples and rounds[-1].samples == self.state.samples

    @property
    def rendering_seconds(self):
        return sum(part.seconds for part in self.state.parts)

    def measure_noise(self):
        self.noise, self.noise_samples = self.reconstruction.noise(), self.state.samples

    def estimate_error(self):
        """Reconstructs both halves and estimates the frame's error."""
        number = len(self.state.rounds)
        self.announce(f"reconstruction {number}", round=number)
        begin = time.monotonic()
        self.reconstruction.reconstruct_halves(number)
        error = self.reconstruction.join_halves(number)
        seconds = time.monotonic() - begin
        error = error if math.isfinite(error) else None
        self.state.rounds.append(
            Round(number, self.state.samples, self.journal.seconds(), seconds, error, next_samples=0.0)
        )
        self.journal.save()

    def start_round(self, samples, if_uniform):
        """Starts a round of so many cost-weighted samples per pixel, or of `if_uniform` where no map places them.
        Returns its plan; None where no round is left."""
        if not self.error_is_known:
            return self.start_uniform_round(len(self.state.rounds) + 1, if_uniform)
        number = len(self.state.rounds) - 1
        taken = self.start_placed_round(number, samples, if_uniform)
        self.state.rounds[-1] = dataclasses.replace(self.state.rounds[-1], next_samples=taken)
        return self.state.next_round
