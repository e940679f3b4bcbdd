"""The adaptive loop of a shot: several frames share one budget.

A few samples of every frame come first. Then each round goes to the frame where the shot's mean error falls most for a
second or a sample (shot_decision.py), and within the frame to the pixels where it falls most, as in the loop of one
frame. At the end all frames are denoised as one sequence, so that frames before and after join (shot_sequence.py); the
seconds for this are kept in reserve.

A frame's error is that of its own reconstruction, without the frames before and after. Where reconstructions take too
long for the budget, the noise of the frames is compared instead: it falls with 1 / n and the error with
n^-CONVERGENCE_RATE, so the error is taken as noise^CONVERGENCE_RATE.

Each frame keeps its journal. The shot has none: what follows is decided from those of the frames, so a run that was
killed goes on as it would have, where the budget is not in seconds."""

import contextlib
import dataclasses

from ..common import folder_lock
from . import shot_sequence
from .budget import Budget
from .folder import PassFolder
from .shot_decision import End, RenderRound, ShotDecision
from .shot_frame import ShotFrame


@dataclasses.dataclass(frozen=True)
class ShotResult:
    frames: list  # (Settings, Result) of each
    budget: Budget
    seconds: float  # In all
    why_ended: str

    @property
    def samples(self):
        """Per pixel, mean of the shot."""
        return self._mean("samples")

    @property
    def error(self):
        """Estimated mean relative MSE, mean of the frames."""
        return self._mean("error")

    @property
    def noise(self):
        return self._mean("noise")

    def _mean(self, name):
        return sum(getattr(result, name) for _, result in self.frames) / len(self.frames)


def run(renderer, polyrecon, frames, progress, tell=lambda notes: None):
    """Runs the loop for the frames of a shot; returns a ShotResult. Raises DriverError; the shot can then be resumed.

    frames: the Settings of each, which differ in their files only. tell: as in adaptive.run."""
    renderer.shot = True
    folder_lock.allow_many(len(frames))
    with contextlib.ExitStack() as folders:
        loops = []
        for settings in frames:
            folders.enter_context(PassFolder(settings.files.passes).claimed())
            loops.append(ShotFrame(renderer, polyrecon, settings, progress))
        return _Shot(renderer, polyrecon, loops, progress, tell).run()


class _Shot:
    """Carries out what ShotDecision decides."""

    def __init__(self, renderer, polyrecon, frames, progress, tell):
        self.renderer, self.polyrecon, self.frames = renderer, polyrecon, frames
        self.progress, self.tell = progress, tell
        self.settings, self.budget = frames[0].settings, frames[0].budget
        self.decision = ShotDecision(frames)
        self.current = None  # The frame that the renderer has open
        for frame in frames:
            frame.on_announce = self.announce

    def run(self):
        for frame in self.frames:
            with self.visit(frame):
                self.render_first_pass(frame)
        self.compare_frames()
        while not isinstance(step := self.decision.next_step(), End):
            if isinstance(step, RenderRound):
                self.render_round(step)
            else:
                self.estimate_errors(step.frames)
        self.announce(self.frames[-1], "result")
        results = shot_sequence.finish(self.polyrecon, self.frames, self.open_for_merging, step.why)
        return ShotResult(results, self.budget, self.decision.seconds(), step.why)

    @contextlib.contextmanager
    def visit(self, frame):
        """A context in which the renderer has this frame open."""
        frame.journal.start_clock()
        try:
            if self.current is not frame:
                if self.current:
                    self.current.rendering = None  # It holds arrays of the frame's size.
                self.current = None
                frame.begin(self.tell)
                frame.open_passes()
                self.current = frame
            yield
        finally:
            frame.journal.stop_clock()

    def open_for_merging(self, frame):
        """A context for merging a frame: only a renderer that adds to the merged file needs the frame open."""
        return self.visit(frame) if self.renderer.completes else contextlib.nullcontext()

    def render_first_pass(self, frame):
        """The first pass and what of it follows uniformly."""
        state = frame.state
        frame.rendering.render_first_pass(self.settings.first_pass)
        if self.budget.seconds and self.decision.decision_seconds is None:
            self.decision.decision_seconds = frame.reconstruction.estimate_decision_seconds()
        plan = state.next_round
        if not plan and not state.rounds and len(state.parts) <= state.first_pass_parts:
            plan = frame.start_uniform_round(0, self.decision.first_samples(frame))
        if plan:
            frame.rendering.render_round(plan)

    def compare_frames(self):
        """Estimates the error of every frame, or its noise where that would take too long."""
        waiting = [frame for frame in self.frames if not frame.state.rounds]
        self.decision.choose_figure(waiting)
        if self.decision.compares_noise:
            for frame in self.frames:
                frame.measure_noise()
        else:
            self.estimate_errors(waiting)

    def estimate_errors(self, frames):
        for frame in frames:
            with self.visit(frame):
                frame.estimate_error()
            self.decision.measure_decisions()

    def render_round(self, step):
        with self.visit(step.frame):
            if plan := step.frame.start_round(step.samples, step.if_uniform):
                step.frame.rendering.render_round(plan)
            else:
                step.frame.has_ended = True

    def announce(self, frame, phase, **figures):
        seconds = self.decision.seconds()
        done = left = None
        if self.budget.samples:
            done = sum(f.state.samples for f in self.frames) / len(self.frames) / self.budget.samples
        elif self.budget.seconds:
            done, left = seconds / self.budget.seconds, self.budget.seconds - seconds
        known = {
            "frame": frame.settings.files.number,
            "samples": frame.state.samples,
            "error": frame.state.error,
            "seconds": round(seconds, 2),
            "seconds_left": left,
        }
        self.progress.update(phase, **{**known, **figures, "done": done})
