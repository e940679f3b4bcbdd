"""The adaptive loop of one frame: a uniform first pass; rounds of reconstruction, error map, sample map and more
samples; the result.

The picture is unbiased. Every pixel has two halves of samples, A and B. Where A's next samples go is decided from B's
samples alone, and the other way round, and the picture is (mean of A + mean of B) / 2. If one set of samples were both
measured and refined, a pixel that is bright by chance would draw the samples that dilute it, and the picture would be
too dark (docs/guide/adaptive.md)."""

import dataclasses
import math
import time

from .budget import (
    SAMPLES_SPENT,
    SECONDS_SPENT,
    reason_to_stop,
    result_over_decision,
    samples_left,
    samples_of_next_round,
    uniform_share,
)
from .decision import UNIFORM_STEPS, what_is_spent
from .folder import PassFolder
from .frame import MAX_ROUNDS, NO_ERROR_LEFT, FrameLoop
from .journal import Round

NO_DECISION = ", too few of them to judge where samples should go"


def run(renderer, polyrecon, settings, progress, tell=lambda notes: None):
    """Runs the loop for one frame; returns a Result. Raises DriverError; the frame can then be resumed.

    tell: gets the notes about the scene before anything is rendered."""
    folder = PassFolder(settings.files.passes)
    with folder.claimed():
        return _Loop(renderer, polyrecon, settings, progress).run(tell)


class _Loop(FrameLoop):
    def __init__(self, renderer, polyrecon, settings, progress):
        super().__init__(renderer, polyrecon, settings, progress)
        if self.state.rounds and not self.state.rounds[-1].next_samples:
            self.state.rounds.pop()  # The loop ended there. Today's budget may be larger, so it is decided again.
        self.open_passes()
        self.decision_seconds = None  # Measured at the last decision, or estimated; None: unknown

    def run(self, tell):
        self.begin(tell)
        self.rendering.render_first_pass(self.settings.first_pass)
        if self.budget.seconds:
            self.decision_seconds = self.reconstruction.estimate_decision_seconds()
        self.continue_first_pass()
        while plan := self.state.next_round or self.decide():
            self.rendering.render_round(plan)
        return self.finish()

    def continue_first_pass(self):
        """More uniform samples before the first decision: a share of a budget of seconds. Where that is none, a half of
        one part gets as many as the first pass took, if they are left: variance is measured between parts."""
        state, plan = self.state, None
        if state.rounds or state.next_round or len(state.parts) > state.first_pass_parts:
            return
        if self.budget.seconds:
            plan = self.start_uniform_round(0, uniform_share(self.budget, self.spent()))
        if not plan and not self.variance_is_known():
            plan = self.start_uniform_round(0, min(self.settings.first_pass, self.samples_left()))
        if plan:
            self.rendering.render_round(plan)

    def decide(self):
        """Reconstructs both halves and decides how many samples follow and where. Returns the plan of the next round;
        None where the loop ends, and sets why_ended then."""
        number = len(self.state.rounds)
        if not self.variance_is_known():
            self.why_ended = (SAMPLES_SPENT if self.budget.samples else SECONDS_SPENT) + NO_DECISION
            return None
        if self.decision_seconds is not None:
            spent = self.spent()
            self.why_ended = reason_to_stop(self.budget, spent)
            if self.why_ended:
                self.why_ended += NO_DECISION if not number else ""
                return self.start_uniform_round(number + 1, samples_left(self.budget, spent))
        self.announce(f"reconstruction {number}", round=number)
        self.decision_seconds = self.reconstruction.reconstruct_halves(number)
        begin = time.monotonic()
        spent = dataclasses.replace(self.spent(), error=self.reconstruction.join_halves(number))
        error = spent.error if math.isfinite(spent.error) else None
        samples, self.why_ended = self.samples_of_next_round(number, spent)
        if samples:
            if_uniform, _ = samples_of_next_round(self.budget, spent, UNIFORM_STEPS)
            samples = self.start_placed_round(number, samples, if_uniform)
            self.why_ended = "" if samples else NO_ERROR_LEFT
        self.decision_seconds += time.monotonic() - begin
        self.state.rounds.append(
            Round(number, spent.samples, spent.seconds, self.decision_seconds, error, next_samples=samples)
        )
        self.journal.save()
        return self.state.next_round

    def samples_of_next_round(self, number, spent):
        """(cost-weighted samples per pixel, reason): as in budget.py, and none beyond --max-rounds."""
        samples, reason = samples_of_next_round(self.budget, spent)
        if samples and number >= self.settings.max_rounds:
            return 0.0, f"{MAX_ROUNDS} {number} is reached"
        return samples, reason

    def finish(self):
        self.announce("result", done=1.0)
        error, noise = self.reconstruction.finish(self.settings)
        self.journal.save()
        return self.result(error, noise)

    def samples_left(self):
        """Samples per pixel that the budget still allows."""
        if self.budget.samples:
            return self.budget.samples - self.state.samples
        return samples_left(self.budget, self.spent()) if self.budget.seconds else math.inf

    def spent(self):
        return what_is_spent(
            self.state,
            self.journal.seconds(),
            self.decision_seconds,
            result_over_decision(self.settings.quality, self.settings.with_prior),
        )

    def announce(self, phase, **figures):
        seconds, budget = self.journal.seconds(), self.budget
        done = left = None
        if budget.samples:
            done = self.state.samples / budget.samples
        elif budget.seconds:
            done, left = seconds / budget.seconds, budget.seconds - seconds
        known = {
            "frame": self.settings.files.number,
            "samples": self.state.samples,
            "error": self.state.error,
            "seconds": round(seconds, 2),
            "seconds_left": left,
            "done": done,
        }
        self.progress.update(phase, **{**known, **figures})
