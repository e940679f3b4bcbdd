"""The adaptive loop of a shot: several frames share one budget.

A few samples of every frame come first. Then each round goes to the frame where the shot's mean error falls most for a
second or a sample (sharing.py), and within the frame to the pixels where it falls most, as in the loop of one frame. At
the end all frames are denoised as one sequence, so that frames before and after join; the seconds for this are kept in
reserve.

A frame's error is that of its own reconstruction, without the frames before and after. Where reconstructions take too
long for the budget, the noise of the frames is compared instead: it falls with 1 / n and the error with
n^-CONVERGENCE_RATE, so the error is taken as noise^CONVERGENCE_RATE.

Each frame keeps its journal. The shot has none: what follows is decided from those of the frames, so a run that was
killed goes on as it would have, where the budget is not in seconds."""

import contextlib
import dataclasses
import math
import os
import time

from ..common import folder_lock
from ..common.frame_names import frame_path, ranges_text
from ..common.work_folder import WorkFolder
from .budget import (
    CONVERGENCE_RATE,
    MAX_DECISION_SHARE,
    SAMPLES_SPENT,
    SECONDS_SPENT,
    UNIFORM_SHARE,
    Budget,
    result_over_decision,
)
from .decision import UNIFORM_STEPS, masked_over_uniform, seconds_per_uniform_sample
from .folder import PassFolder
from .frame import MAX_ROUNDS, NO_ERROR_LEFT, FrameLoop
from .journal import HALVES, Round
from .sharing import Figures, left_to_target, next_slice

# Seconds of the reconstruction of a frame with two neighbours on either side over those of one without, for each
# --quality: (per_pixel + 4 neighbour) / per_pixel, the seconds of pipelines/farm/model.json.
NEIGHBOURS_OVER_ALONE = {"draft": 1.6, "standard": 1.13, "best": 1.04}

NUMBER = "####"  # In the names of the files that are denoised as a sequence


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
            loops.append(_Frame(renderer, polyrecon, settings, progress))
        return _Shot(renderer, polyrecon, loops, progress, tell).run()


class _Frame(FrameLoop):
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


class _Shot:
    def __init__(self, renderer, polyrecon, frames, progress, tell):
        self.renderer, self.polyrecon, self.frames = renderer, polyrecon, frames
        self.progress, self.tell = progress, tell
        self.settings, self.budget = frames[0].settings, frames[0].budget
        self.before, self.begin = sum(frame.state.seconds for frame in frames), time.monotonic()
        self.decision_seconds = None  # Of a frame: measured, or estimated; None: unknown
        self.compares_noise = False
        self.current = None  # The frame that the renderer has open
        self.why_ended = ""
        for frame in frames:
            frame.on_announce = self.announce

    def run(self):
        for frame in self.frames:
            with self.visit(frame):
                self.render_first_pass(frame)
        self.compare_frames()
        while choice := self.next_round():
            frame, samples, if_uniform = choice
            with self.visit(frame):
                if plan := frame.start_round(samples, if_uniform):
                    frame.rendering.render_round(plan)
                else:
                    frame.has_ended = True
        return self.finish()

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

    def render_first_pass(self, frame):
        """The first pass and what of it follows uniformly: the share of a budget of seconds, or as much as the variance
        needs."""
        state = frame.state
        frame.rendering.render_first_pass(self.settings.first_pass)
        if self.budget.seconds and self.decision_seconds is None:
            self.decision_seconds = frame.reconstruction.estimate_decision_seconds()
        plan = state.next_round
        if not plan and not state.rounds and len(state.parts) <= state.first_pass_parts:
            samples = 0.0
            if self.budget.seconds:
                share = UNIFORM_SHARE * (self.budget.seconds - self.result_seconds()) / len(self.frames)
                samples = (share - frame.rendering_seconds) / self.price(frame)
            if not frame.variance_is_known() and self.left() > 0:
                samples = max(samples, float(self.settings.first_pass))
            plan = frame.start_uniform_round(0, samples)
        if plan:
            frame.rendering.render_round(plan)

    def compare_frames(self):
        """Estimates the error of every frame, or its noise where that would take too long."""
        waiting = [frame for frame in self.frames if not frame.state.rounds]
        known = all(frame.variance_is_known() for frame in self.frames)
        estimate_seconds = len(waiting) * (self.decision_seconds or 0.0)
        if not known or (self.budget.seconds and estimate_seconds > MAX_DECISION_SHARE * self.left()):
            self.compares_noise = True
            for frame in self.frames:
                frame.measure_noise()
            return
        for frame in waiting:
            self.estimate_error(frame)

    def estimate_error(self, frame):
        with self.visit(frame):
            frame.estimate_error()
        if self.budget.seconds:
            known = [entry.decision_seconds for frame in self.frames for entry in frame.state.rounds]
            self.decision_seconds = sum(known) / len(known)

    def next_round(self):
        """(frame, cost-weighted samples per pixel, the same if they are uniform) of the next round. None where the loop
        ends, and sets why_ended then."""
        while True:
            frames = [frame for frame in self.frames if not self.cannot_go_on(frame)]
            figures = [self.figures(frame) for frame in frames]
            left = self.left_for(frames, figures)
            found = next_slice(figures, left)
            if not found:
                if self.budget.target and (unsure := [frame for frame in frames if not frame.error_is_known]):
                    for frame in unsure:
                        self.estimate_error(frame)
                    continue
                self.why_ended = self.reason_to_stop(frames, figures)
                return None
            index, amount, share = found
            frame, price, step = frames[index], figures[index].price, figures[index].step
            if not frame.error_is_known and self.estimate_pays(share):
                self.estimate_error(frame)
                continue
            # Where no decision pays now, no later one will.
            if_uniform = min(share, UNIFORM_STEPS * step) if frame.error_is_known else share
            return frame, amount / price, if_uniform / price

    def cannot_go_on(self, frame):
        return frame.has_ended or self.rounds_are_done(frame)

    def rounds_are_done(self, frame):
        return sum(entry.next_samples > 0 for entry in frame.state.rounds) >= self.settings.max_rounds

    def estimate_pays(self, share):
        """Whether a decision pays on a frame that gets so many units of the budget."""
        if self.compares_noise:
            return False
        return not self.budget.seconds or self.decision_seconds <= MAX_DECISION_SHARE * share

    def reason_to_stop(self, frames, figures):
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

    def seconds(self):
        """Seconds since the loop began, without the time between a kill and the next run."""
        return self.before + time.monotonic() - self.begin

    def finish(self):
        self.announce(self.frames[-1], "result")
        # Next to the passes, since it holds as much as they do.
        with WorkFolder("shot", self.frames[0].folder.path) as folder:
            self.merge_all(folder)
            self.denoise(folder)
            results = [self.deliver(frame, folder) for frame in self.frames]
        return ShotResult(results, self.budget, self.seconds(), self.why_ended)

    def merge_all(self, folder):
        for frame in self.frames:
            # Only a renderer that adds to the merged file needs the frame open.
            with self.visit(frame) if self.renderer.completes else contextlib.nullcontext():
                frame.reconstruction.merge_all(_file(folder, "merged", frame))

    def denoise(self, folder):
        """Denoises the frames as one sequence, with those before and after."""
        pattern = {name: folder / f"{name}.{NUMBER}.exr" for name in ("merged", "clean", "error")}
        words = ["--frames", ranges_text([frame.settings.files.number for frame in self.frames])]
        words += self.frames[0].reconstruction.result_options(self.settings)
        files = ["-i", pattern["merged"], "-o", pattern["clean"], "--error-map", pattern["error"]]
        self.polyrecon.run("denoise", *files, *words)

    def deliver(self, frame, folder):
        """Writes the outputs of a frame; returns its (Settings, Result)."""
        for name in ("merged", "clean"):
            os.replace(_file(folder, name, frame), getattr(frame.folder, name))
        os.replace(_file(folder, "error", frame), frame.folder.error_map)
        frame.why_ended = self.why_ended
        error, noise = frame.reconstruction.deliver(frame.settings)
        frame.journal.save()
        return frame.settings, frame.result(error, noise)

    def announce(self, frame, phase, **figures):
        seconds = self.seconds()
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


def _file(folder, name, frame):
    return folder / frame_path(f"{name}.{NUMBER}.exr", frame.settings.files.number)
