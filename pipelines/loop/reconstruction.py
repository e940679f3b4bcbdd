"""Runs the polyrecon program on the parts of a frame: the halves at each decision, and all samples at the end."""

import itertools
import os
import time

import numpy as np

from ..common import exr, outputs
from .budget import CONVERGENCE_RATE
from .counts import cost_of_samples, quantise
from .journal import HALVES
from .renderer import RENDER_SECONDS, SAMPLE_COUNT

DECISION_QUALITY = "draft"

# Seconds of a decision over those of merging two parts, as long as no decision was made
# (docs/lab/2026-11-27-loop-seconds.md).
DECISION_OVER_MERGE = 8.5

MIN_COUNT_LIMIT = 1024  # A sample map may always put this many samples into one pixel.

SETTINGS_ATTRIBUTE = "polyrecon/loop"  # of a result: the digest of its settings
PRIOR = ("--prior", "oidn")
UNCOMPRESSED = ("--compression", "none")  # Merged files are read again at once.


class Reconstruction:
    """with_prior: whether Open Image Denoise's picture takes part."""

    def __init__(self, polyrecon, renderer, folder, state, audit, with_prior):
        self.polyrecon, self.renderer, self.folder, self.state, self.audit = polyrecon, renderer, folder, state, audit
        self.prefix = f"{audit.beauty}." if audit.beauty else ""
        self.prior = PRIOR if with_prior else ()

    def estimate_decision_seconds(self):
        """Seconds that a decision will take, from a trial merge of the first part of each half."""
        trial = self.folder.in_round(0, "first")
        self.folder.create_round(0)
        begin = time.monotonic()
        parts = [self._files(half)[0] for half in HALVES]
        self.polyrecon.run("merge", *parts, "-o", trial, *UNCOMPRESSED, "--quiet")
        seconds = time.monotonic() - begin
        trial.unlink()
        return DECISION_OVER_MERGE * seconds

    def reconstruct_halves(self, number):
        """Writes merged_, clean_ and error_ files of both halves; returns the seconds that later decisions need for it.
        Both halves run at once, each on half of the processors: a draft of one frame does not keep all of them busy."""
        self.folder.create_round(number)
        begin = time.monotonic()
        merged = {half: self.folder.in_round(number, f"merged_{half}") for half in HALVES}
        self.polyrecon.run_side_by_side(
            "merge", [[*self._files(half), "-o", merged[half], *UNCOMPRESSED, "--quiet"] for half in HALVES]
        )
        begin_completing = time.monotonic()
        for half in HALVES:
            self.renderer.complete(merged[half])
        begin += time.monotonic() - begin_completing  # It may render feature passes, which no later decision repeats.
        threads = max(1, len(os.sched_getaffinity(0)) // len(HALVES))
        options = ["--quality", DECISION_QUALITY, "--threads", threads, "--quiet"]
        outputs = {
            half: ["-o", self.folder.in_round(number, f"clean_{half}"), "--error-map", self._error_map(number, half)]
            for half in HALVES
        }
        self.polyrecon.run_side_by_side("denoise", [["-i", merged[half], *outputs[half], *options] for half in HALVES])
        return time.monotonic() - begin

    def join_halves(self, number):
        """Writes the means of what the halves show, for the report, and returns the mean of their relative MSE:
        estimated for a reconstruction of both halves, which has twice the samples of one. NaN where no pixel's error is
        finite."""
        maps = [exr.read(self._error_map(number, half)) for half in HALVES]
        error = sum(channels["relmse.Y"] for channels in maps) / 2 * 2**-CONVERGENCE_RATE
        exr.write(self.folder.in_round(number, "error"), {"relmse.Y": error})
        for kind, name in (("merged", "noisy"), ("clean", "clean")):
            files = [self.folder.in_round(number, f"{kind}_{half}") for half in HALVES]
            a, b = (self._picture(file) for file in files)
            exr.write(self.folder.in_round(number, name), {channel: (a[channel] + b[channel]) / 2 for channel in a})
            for file in files:
                file.unlink()
        return float(np.nanmean(error))

    def error_maps(self, number):
        return {half: exr.read(self._error_map(number, half)) for half in HALVES}

    def sample_counts(self, number, samples, taken):
        """Counts of each half's next samples, half of `samples` for each, from the other half's error map and costs.

        taken: what each half has taken so far; the costs come from its seconds."""
        other = dict(zip(HALVES, reversed(HALVES)))
        costs = {half: cost_of_samples(taken[other[half]]) for half in HALVES}
        files = {half: [self.folder.in_round(number, f"{kind}_{half}") for kind in ("cost", "map")] for half in HALVES}
        for half, (cost_file, _) in files.items():
            exr.write(cost_file, {"Y": costs[half]})
        options = ["--budget", samples / 2, "--max-samples", max(MIN_COUNT_LIMIT, 4 * samples), "--quiet"]
        self.polyrecon.run_side_by_side(
            "samplemap",
            [
                ["--error-map", self._error_map(number, other[half]), *options, "--cost", cost_file, "-o", map_file]
                for half, (cost_file, map_file) in files.items()
            ],
        )
        counts = {half: quantise(exr.read(map_file)["samples.Y"], costs[half]) for half, (_, map_file) in files.items()}
        for file in itertools.chain(*files.values()):
            file.unlink()
        return counts

    def noise(self):
        """Mean over the frame of the relative variance of the uniform samples' mean, by the difference of its halves.
        No denoising is needed for it. NaN where no pixel is finite."""
        a, b = (self._uniform_mean(half) for half in HALVES)
        difference = sum(np.square(a[channel] - b[channel]) for channel in a)
        total = sum(np.square(a[channel] + b[channel]) for channel in a)
        return float(np.nanmean(difference / np.maximum(total, 1e-12)))

    def _uniform_mean(self, half):
        """Channels of the picture: the mean of the uniform samples of a half."""
        parts = [part for part in self.state.parts if part.half == half and not part.masked]
        samples = sum(part.samples for part in parts)
        pictures = [self._picture(self.folder.path / part.file) for part in parts]
        return {
            c: sum(part.samples / samples * picture[c] for part, picture in zip(parts, pictures)) for c in pictures[0]
        }

    def merge_all(self, merged):
        """Merges all parts into a file, for the result."""
        a, b = (self._files(half) for half in HALVES)
        self.polyrecon.run("merge", *a, "--half-b", *b, "-o", merged, *UNCOMPRESSED, "--quiet")
        self.renderer.complete(merged)
        self.renderer.add_own_passes(merged)

    def finish(self, settings):
        """Merges all parts, reconstructs them, and writes the outputs of the settings. Returns the mean relative MSE
        that is estimated for the picture, and that of the noise before."""
        self.merge_all(self.folder.merged)
        files = ["-i", self.folder.merged, "-o", self.folder.clean, "--error-map", self.folder.error_map]
        self.polyrecon.run("denoise", *files, *self.result_options(settings))
        return self.deliver(settings)

    def result_options(self, settings):
        """Options of `polyrecon denoise` for the result."""
        return ["--quality", settings.quality, "--outputs", settings.contents, *self.prior, "--quiet"]

    def deliver(self, settings):
        """Writes the outputs of the settings from the reconstruction in the folder, which is removed there. Returns as
        finish does."""
        files, clean, error_map = settings.files, self.folder.clean, self.folder.error_map
        if files.error_map:
            outputs.copy(error_map, files.error_map)
        compression = outputs.encoding(settings.compression or self.audit.compression, settings.dwa_level)
        attributes = {SETTINGS_ATTRIBUTE: settings.digest()}
        note = outputs.deliver(clean, files.output, self._type_of(settings), compression, attributes)
        self.audit.notes += [note] if note else []
        clean.unlink()
        found = exr.read(error_map, lambda name: name in ("relmse.Y", "relnoise.Y"))
        return tuple(float(np.nanmean(found[name])) for name in ("relmse.Y", "relnoise.Y"))

    def _type_of(self, settings):
        """The type of each channel of the result, as a function of its name; None: it is left out."""
        merged = set(exr.names(self.folder.merged))
        rendered = {name.rpartition(".")[0] for name in exr.names(self._files(HALVES[0])[0])}

        def is_working(name):
            """Whether only the reconstruction needs the channel. What the reconstruction adds was not merged."""
            layer = name.rpartition(".")[0]
            if layer in self.audit.working or name.endswith((SAMPLE_COUNT, RENDER_SECONDS)):
                return True
            return name in merged and layer not in rendered

        def type_of(name):
            if is_working(name):
                return "float" if settings.keeps_working_layers else None
            return "half" if outputs.is_colour(name) and not self.audit.float_colours else "float"

        return type_of

    def _files(self, half):
        return [self.folder.path / file for file in self.state.files(half)]

    def _error_map(self, number, half):
        return self.folder.in_round(number, f"error_{half}")

    def _picture(self, path):
        channels = exr.read(path, lambda name: name in {self.prefix + channel for channel in "RGB"})
        return {channel: channels[self.prefix + channel] for channel in "RGB"}
