"""One frame of a loop: its journal, its passes, and the steps of its rounds. adaptive.py takes these steps for one
frame, shot.py for the frames of a shot."""

import dataclasses
import hashlib
import json
import pathlib
from typing import Optional

from ..common.command import Frame
from ..common.denoise_defaults import DEFAULT_OUTPUTS, DEFAULT_QUALITY
from ..common.digests import digest
from ..common.outputs import DEFAULT_DWA_LEVEL
from .budget import Budget
from .decision import first_pass_parts, map_pays, plan_round, uniform_counts, uniform_samples
from .folder import PassFolder
from .journal import HALVES, Journal, State
from .reconstruction import Reconstruction
from .renderer import Audit
from .rendering import PartRendering

MIN_UNIFORM_COUNT = 1  # Samples of each half: a uniform round of fewer does not exist.
MAX_ROUNDS = "--max-rounds"  # In the reason where that option ended the loop.
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
    keep_passes: bool = False  # Whether the folder of passes stays
    contents: str = DEFAULT_OUTPUTS  # --outputs: what the picture's file holds
    compression: Optional[str] = None  # The picture's, in OpenImageIO's words; None: the scene's
    dwa_level: float = DEFAULT_DWA_LEVEL
    identity: dict = dataclasses.field(default_factory=dict)  # Digests of the scene: see journal.State
    scene: Optional[str] = None  # Path of the input that is compared where the renderer lists none
    shot: tuple = ()  # Numbers of the shot's frames, which share the budget; empty: a frame by itself

    @property
    def passes_identity(self):
        """Identity of the render passes. Passes of another identity cannot be added to them. Samples of a shot have
        other seeds than those of a frame by itself."""
        shot = {"shot": True} if self.shot else {}
        return {**self.identity, **shot, "frame": self.files.number, "first_pass": self.first_pass}

    @property
    def keeps_working_layers(self):
        """Whether the picture's file has the layers that only the reconstruction needs."""
        return self.keep_passes and DEFAULT_OUTPUTS in self.contents.split(",")

    def digest(self):
        """The SHA-256 of the scene and of every setting that changes the picture or its file."""
        chosen = [self.passes_identity, dataclasses.asdict(self.budget), self.max_rounds, self.quality, self.with_prior]
        chosen += [self.contents, self.compression, self.dwa_level]
        chosen += [list(self.shot)] if self.shot else []
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


class FrameLoop:
    def __init__(self, renderer, polyrecon, settings, progress):
        self.renderer, self.polyrecon, self.settings, self.progress = renderer, polyrecon, settings, progress
        self.budget, self.folder = settings.budget, PassFolder(settings.files.passes)
        new_state = State(settings.passes_identity, first_pass_parts=first_pass_parts(settings.first_pass, self.budget))
        self.journal = Journal.open(self.folder, new_state, settings.resume)
        self.state = self.journal.state
        self.why_ended = ""

    def open_passes(self):
        """Reads what the parts hold. Called before any pass is rendered."""
        self.rendering = PartRendering(self.renderer, self.folder, self.journal, self.announce)

    def begin(self, tell):
        """Opens the frame in the renderer. tell: gets the notes about the scene."""
        self.audit = self.renderer.begin(self.settings.files.number)
        tell(self.audit.notes)
        scene = self.settings.scene
        self.journal.compare_inputs(self.audit.inputs or ({scene: digest(scene)} if scene else {}))
        self.reconstruction = Reconstruction(
            self.polyrecon, self.renderer, self.folder, self.state, self.audit, self.settings.with_prior
        )

    def start_placed_round(self, number, samples, if_uniform):
        """Starts a round of so many cost-weighted samples per pixel where the error maps of decision `number` want
        them. Where uniform samples leave less error, the round takes `if_uniform` of these. Returns the samples of the
        round; 0 where no error is left."""
        taken = self.rendering.taken
        if self.budget.samples:  # Every sample counts alike then, whatever it costs.
            taken = {half: dataclasses.replace(taken[half], seconds=None) for half in HALVES}
        counts = self.reconstruction.sample_counts(number, samples, taken)
        uniform = self.uniform_samples(samples)
        if uniform >= 2 and not map_pays(self.reconstruction.error_maps(number), taken, counts, uniform):
            samples = if_uniform
            counts = self.uniform_counts(self.uniform_samples(samples))
        if not any(values.any() for values in counts.values()):
            return 0.0
        self.rendering.start_round(plan_round(self.state, number + 1, counts, samples), counts)
        return samples

    def start_uniform_round(self, number, samples):
        """Starts a uniform round, or continues one, that takes as long as `samples` of a masked round would. Returns
        its plan; None where they are too few."""
        counts = self.uniform_counts(self.uniform_samples(samples))
        most = int(counts["a"].max())
        if most < MIN_UNIFORM_COUNT:
            return None
        plan = plan_round(self.state, number, counts, len(HALVES) * most)
        self.rendering.start_round(plan, counts)
        return self.state.next_round

    def uniform_samples(self, samples):
        return uniform_samples(self.budget, self.state.parts, samples)

    def uniform_counts(self, samples):
        return uniform_counts(self.rendering.taken["a"].counts.shape, self.state.parts, samples)

    def variance_is_known(self):
        return all(len(self.state.files(half)) > 1 for half in HALVES)

    def result(self, error, noise):
        """The Result of the finished frame. error, noise: as in Result."""
        return Result(
            audit=self.audit,
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
