"""Whose turn it is in a shot, and how much: decided from the states of all frames. It renders and reconstructs
nothing."""

import dataclasses
import math
import time
from typing import Any

from .budget import (
    CONVERGENCE_RATE,
    MAX_DECISION_SHARE,
    SAMPLES_SPENT,
    SECONDS_SPENT,
    UNIFORM_SHARE,
    result_over_decision,
)
from .decision import UNIFORM_STEPS, masked_over_uniform, seconds_per_uniform_sample
from .frame import MAX_ROUNDS, NO_ERROR_LEFT
from .sharing import Figures, left_to_target, next_slice

# Seconds of the reconstruction of a frame with two neighbours on either side over those of one without, for each
# --quality: (per_pixel + 4 neighbour) / per_pixel, the seconds of pipelines/farm/model.json.
NEIGHBOURS_OVER_ALONE = {"draft": 1.6, "standard": 1.13, "best": 1.04}


@dataclasses.dataclass(frozen=True)
class RenderRound:
    """The next step is a round of this frame, in cost-weighted samples per pixel."""

    frame: Any
    samples: float
    if_uniform: float  # The same where no map places them


@dataclasses.dataclass(frozen=True)
class EstimateErrors:
    """The next step is to estimate the errors of these frames."""

    frames: list


@dataclasses.dataclass(frozen=True)
class End:
    why: str


class ShotDecision:
    """frames: the ShotFrame of each, whose states are read whenever something is asked."""

    def __init__(self, frames):
        self.frames, self.settings, self.budget = frames, frames[0].settings, frames[0].budget
        self.before, self.begin = sum(frame.state.seconds for frame in frames), time.monotonic()
        self.decision_seconds = None  # Of a frame: measured, or estimated; None: unknown
        self.compares_noise = False

    def seconds(self):
        """Seconds since the loop began, without the time between a kill and the next run."""
        return self.before + time.monotonic() - self.begin

    def first_samples(self, frame):
        """Uniform samples per pixel that follow a frame's first pass: the share of a budget of seconds, or as many as
        the variance needs."""
        samples = 0.0
        if self.budget.seconds:
            share = UNIFORM_SHARE * (self.budget.seconds - self.result_seconds()) / len(self.frames)
            samples = (share - frame.rendering_seconds) / self.price(frame)
        if not frame.variance_is_known() and self.left() > 0:
            samples = max(samples, float(self.settings.first_pass))
        return samples

    def choose_figure(self, waiting):
        """Sets compares_noise: whether the frames are compared by their noise. That is so where their variance is
        unknown, or where the errors of those `waiting` would take too long to estimate."""
        known = all(frame.variance_is_known() for frame in self.frames)
        estimate_seconds = len(waiting) * (self.decision_seconds or 0.0)
        too_long = self.budget.seconds and estimate_seconds > MAX_DECISION_SHARE * self.left()
        self.compares_noise = not known or bool(too_long)

    def measure_decisions(self):
        """Learns what a decision takes from those that were made."""
        if self.budget.seconds:
            known = [entry.decision_seconds for frame in self.frames for entry in frame.state.rounds]
            self.decision_seconds = sum(known) / len(known)

    def next_step(self):
        """What is done next: a RenderRound, EstimateErrors or the End."""
        frames = [frame for frame in self.frames if not self.cannot_go_on(frame)]
        figures = [self.figures(frame) for frame in frames]
        found = next_slice(figures, self.left_for(frames, figures))
        if not found:
            unsure = [frame for frame in frames if not frame.error_is_known]
            return EstimateErrors(unsure) if self.budget.target and unsure else End(self.reason_to_stop(figures))
        index, amount, share = found
        frame, price, step = frames[index], figures[index].price, figures[index].step
        if not frame.error_is_known and self.estimate_pays(share):
            return EstimateErrors([frame])
        # Where no decision pays now, no later one will.
        if_uniform = min(share, UNIFORM_STEPS * step) if frame.error_is_known else share
        return RenderRound(frame, amount / price, if_uniform / price)

    def cannot_go_on(self, frame):
        return frame.has_ended or self.rounds_are_done(frame)

    def rounds_are_done(self, frame):
        return sum(entry.next_samples > 0 for entry in frame.state.rounds) >= self.settings.max_rounds

    def estimate_pays(self, share):
        """Whether a decision pays on a frame that gets so many units of the budget."""
        if self.compares_noise:
            return False
        return not self.budget.seconds or self.decision_seconds <= MAX_DECISION_SHARE * share

    def reason_to_stop(self, figures):
        if self.budget.target and self.mean_error() <= self.budget.target:
            return f"the target is reached: {self.mean_error():.3g}"
        if any(f.error > 0 for f in figures):
            return SAMPLES_SPENT if self.budget.samples else SECONDS_SPENT
        if any(self.rounds_are_done(frame) for frame in self.frames):
            return f"{MAX_ROUNDS} {self.settings.max_rounds} is reached"
        return NO_ERROR_LEFT

    def figures(self, frame):
        state = frame.state
        if self.compares_noise:
            error, samples = frame.noise**CONVERGENCE_RATE, frame.noise_samples
        else:
            error, samples = state.error, state.rounds[-1].samples
        error = error if error is not None and math.isfinite(error) else 0.0
        expected = error * (samples / state.samples) ** CONVERGENCE_RATE
        if self.budget.samples:
            return Figures(expected, state.samples, price=1.0)
        price = self.price(frame)
        spent = price * sum(part.cost_weighted_samples for part in state.parts)
        uses_seconds = self.budget.seconds and not self.compares_noise
        return Figures(expected, spent, price, self.decision_seconds / MAX_DECISION_SHARE if uses_seconds else 0.0)

    def price(self, frame):
        """Seconds of one sample of average cost in every pixel."""
        parts = frame.state.parts
        return max(1e-9, seconds_per_uniform_sample(parts) * masked_over_uniform(parts))

    def left_for(self, frames, figures):
        """What is left of the budget for these frames, in its units."""
        if not self.budget.target:
            return self.left()
        if not figures or not any(f.error > 0 for f in figures):
            return 0.0
        others = sum(frame.state.error or 0.0 for frame in self.frames if frame not in frames)
        target = (self.budget.target * len(self.frames) - others) / len(figures)
        # Below 0: the other frames alone have more error than all may have.
        return left_to_target(figures, target) if target > 0 else sum(f.step for f in figures)

    def left(self):
        """What is left of the budget, in its units; none where that is a target."""
        if self.budget.samples:
            return self.budget.samples * len(self.frames) - sum(frame.state.samples for frame in self.frames)
        return self.budget.seconds - self.seconds() - self.result_seconds() if self.budget.seconds else math.inf

    def mean_error(self):
        return sum(frame.state.error or 0.0 for frame in self.frames) / len(self.frames)

    def result_seconds(self):
        """Seconds that the last reconstruction of all frames will take."""
        quality = self.settings.quality
        over_decision = result_over_decision(quality, self.settings.with_prior) * NEIGHBOURS_OVER_ALONE[quality]
        return len(self.frames) * (self.decision_seconds or 0.0) * over_decision
