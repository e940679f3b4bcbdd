"""The adaptive loop of one frame: a uniform first pass; rounds of reconstruction, error map, sample map and more
samples; the result.

The picture is unbiased. Every pixel has two halves of samples, A and B. Where A's next samples go is decided from B's
samples alone, and the other way round, and the picture is (mean of A + mean of B) / 2. If one set of samples were both
measured and refined, a pixel that is bright by chance would draw the samples that dilute it, and the picture would be
too dark (docs/guide/adaptive.md)."""

import dataclasses
import hashlib
import json
import math
import pathlib
import time
from typing import Optional

from ..common.command import Frame
from ..common.denoise_defaults import DEFAULT_QUALITY
from ..common.digests import digest
from ..common.outputs import DEFAULT_DWA_LEVEL
from .budget import (
    SAMPLES_SPENT,
    SECONDS_SPENT,
    Budget,
    reason_to_stop,
    result_over_decision,
    samples_left,
    samples_of_next_round,
    uniform_share,
)
from .decision import (
    UNIFORM_STEPS,
    first_pass_parts,
    map_pays,
    plan_round,
    uniform_counts,
    uniform_samples,
    what_is_spent,
)
from .folder import PassFolder
from .journal import HALVES, Journal, Round, State
from .reconstruction import Reconstruction
from .renderer import Audit
from .rendering import PartRendering

MIN_UNIFORM_COUNT = 1  # Samples of each half: a uniform round of fewer does not exist.
NO_DECISION = ", too few of them to judge where samples should go"
NO_ERROR_LEFT = "no error is left that more samples could lower"


@dataclasses.dataclass(frozen=True)
class Settings:
    files: Frame
    budget: Budget
    first_pass: int = 8  # Samples per pixel
    max_rounds: int = 8
    quality: str = DEFAULT_QUALITY  # That of the last reconstruction
    resume: bool = False
    with_prior: bool = False  # Whether Open Image Denoise gives a second opinion
    keep_passes: bool = False  # Whether the picture has the channels that only the reconstruction needs
    compression: Optional[str] = None  # The picture's, in OpenImageIO's words; None: the scene's
    dwa_level: float = DEFAULT_DWA_LEVEL
    identity: dict = dataclasses.field(default_factory=dict)  # Digests of the scene: see journal.State
    scene: Optional[str] = None  # Path of the input that is compared where the renderer lists none

    @property
    def passes_identity(self):
        """Identity of the render passes. Passes of another identity cannot be added to them."""
        return {**self.identity, "frame": self.files.number, "first_pass": self.first_pass}

    def digest(self):
        """The SHA-256 of the scene and of every setting that changes the picture."""
        chosen = [self.passes_identity, dataclasses.asdict(self.budget), self.max_rounds, self.quality, self.with_prior]
        scene = digest(self.scene) if self.scene else None
        return hashlib.sha256(json.dumps([scene, *chosen], sort_keys=True).encode()).hexdigest()


@dataclasses.dataclass(frozen=True)
class Result:
    audit: Audit
    renderer: str  # Name and version
    state: State
    merged: pathlib.Path
    error_map: pathlib.Path
    error: float  # Estimated mean relative MSE of the picture
    noise: float  # Mean relative noise variance of the samples' mean
    samples: float  # Per pixel, mean of the frame
    seconds: float
    why_ended: str


def run(renderer, polyrecon, settings, progress, tell=lambda notes: None):
    """Runs the loop for one frame; returns a Result. Raises DriverError; the frame can then be resumed.

    tell: gets the notes about the scene before anything is rendered."""
    folder = PassFolder(settings.files.passes)
    with folder.claimed():
        return _Loop(renderer, polyrecon, settings, folder, progress).run(tell)


class _Loop:
    def __init__(self, renderer, polyrecon, settings, folder, progress):
        self.renderer, self.polyrecon, self.settings, self.progress = renderer, polyrecon, settings, progress
        self.budget, self.folder = settings.budget, folder
        new_state = State(settings.passes_identity, first_pass_parts=first_pass_parts(settings.first_pass, self.budget))
        self.journal = Journal.open(self.folder, new_state, settings.resume)
        self.state = self.journal.state
        if self.state.rounds and not self.state.rounds[-1].next_samples:
            self.state.rounds.pop()  # The loop ended there. Today's budget may be larger, so it is decided again.
        self.rendering = PartRendering(renderer, self.folder, self.journal, self.announce)
        self.why_ended = ""
        self.decision_seconds = None  # Measured at the last decision, or estimated; None: unknown

    def run(self, tell):
        audit = self.renderer.begin(self.settings.files.number)
        tell(audit.notes)
        scene = self.settings.scene
        self.journal.compare_inputs(audit.inputs or ({scene: digest(scene)} if scene else {}))
        self.reconstruction = Reconstruction(
            self.polyrecon, self.renderer, self.folder, self.state, audit, self.settings.with_prior
        )
        self.rendering.render_first_pass(self.settings.first_pass)
        if self.budget.seconds:
            self.decision_seconds = self.reconstruction.estimate_decision_seconds()
        self.continue_first_pass()
        while plan := self.state.next_round or self.decide():
            self.rendering.render_round(plan)
        return self.finish(audit)

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
        samples, counts = self.place_samples(number, spent)
        self.decision_seconds += time.monotonic() - begin
        error = spent.error if math.isfinite(spent.error) else None
        self.state.rounds.append(
            Round(number, spent.samples, spent.seconds, self.decision_seconds, error, next_samples=samples)
        )
        if samples:
            self.rendering.start_round(plan_round(self.state, number + 1, counts, samples), counts)
        self.journal.save()
        return self.state.next_round

    def place_samples(self, number, spent):
        """(cost-weighted samples per pixel, counts of each half) of the next round; no samples where the loop ends, and
        sets why_ended then."""
        samples, self.why_ended = samples_of_next_round(self.budget, spent)
        if samples and number >= self.settings.max_rounds:
            samples, self.why_ended = 0.0, f"{number} rounds are done (--max-rounds)"
        if not samples:
            return 0.0, {}
        taken = self.rendering.taken
        if self.budget.samples:  # Every sample counts alike then, whatever it costs.
            taken = {half: dataclasses.replace(taken[half], seconds=None) for half in HALVES}
        counts = self.reconstruction.sample_counts(number, samples, taken)
        uniform = self.uniform_samples(samples)
        if uniform >= 2 and not map_pays(self.reconstruction.error_maps(number), taken, counts, uniform):
            samples, _ = samples_of_next_round(self.budget, spent, UNIFORM_STEPS)
            counts = self.uniform_counts(self.uniform_samples(samples))
        if not any(values.any() for values in counts.values()):
            self.why_ended = NO_ERROR_LEFT
            return 0.0, {}
        return samples, counts

    def start_uniform_round(self, number, samples):
        """Starts a uniform round, or continues one, that takes as long as `samples` of a masked round would. None where
        they are too few."""
        counts = self.uniform_counts(self.uniform_samples(samples))
        most = int(counts["a"].max())
        if most < MIN_UNIFORM_COUNT:
            return None
        plan = plan_round(self.state, number, counts, len(HALVES) * most)
        self.rendering.start_round(plan, counts)
        return self.state.next_round

    def finish(self, audit):
        self.announce("result", done=1.0)
        error, noise = self.reconstruction.finish(self.settings)
        self.journal.save()
        return Result(
            audit=audit,
            renderer=self.renderer.name,
            state=self.state,
            merged=self.folder.merged,
            error_map=self.folder.error_map,
            error=error,
            noise=noise,
            samples=self.state.samples,
            seconds=self.journal.seconds(),
            why_ended=self.why_ended,
        )

    def variance_is_known(self):
        return all(len(self.state.files(half)) > 1 for half in HALVES)

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

    def uniform_samples(self, samples):
        return uniform_samples(self.budget, self.state.parts, samples)

    def uniform_counts(self, samples):
        return uniform_counts(self.rendering.taken["a"].counts.shape, self.state.parts, samples)

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
