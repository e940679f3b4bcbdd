"""Renders the first pass and the rounds of a frame, part by part, and enters each part into the journal."""

import dataclasses
import itertools
import time

import numpy as np

from ..common import exr
from ..common.digests import digest
from ..common.errors import DriverError, ExitCode
from .counts import Taken
from .journal import HALVES, Part
from .renderer import RENDER_SECONDS, SAMPLE_COUNT


class PartRendering:
    """announce(phase, **figures) is called before each part. `taken` holds the sums over the finished parts of each
    half."""

    def __init__(self, renderer, folder, journal, announce):
        self.renderer, self.folder, self.journal, self.announce = renderer, folder, journal, announce
        self.state = journal.state
        self.taken = {}
        for part in self.state.parts:
            taken = read_taken(folder.path / part.file)
            self._check(part, taken)
            self._add(part.half, taken)

    def render_first_pass(self, samples):
        """The first half of the parts is half A, the second half B. Each half is then a block of the sequence, and
        blocks are better spread over the pixel than every other sample would be."""
        parts = self.state.first_pass_parts
        each = samples // parts
        for index in range(parts):
            half, index_in_half = HALVES[index * 2 // parts], index % (parts // 2)
            if self.state.part_count(0, half) <= index_in_half:
                self.announce("first pass", done=index / parts)
                self._render_part(0, half, index_in_half, index * each, samples=each)
        self.state.next_sample = max(self.state.next_sample, samples)

    def start_round(self, plan, counts):
        """Makes the plan the state's next round; its counts go into files."""
        self.folder.create_round(plan.round)
        counts_sha256 = {}
        for half in HALVES:
            file = self.folder.in_round(plan.round, f"counts_{half}")
            exr.write(file, {"samples.Y": counts[half]})
            counts_sha256[half] = digest(file)
        exr.write(self.folder.in_round(plan.round, "samples"), {"samples.Y": counts["a"] + counts["b"]})
        self.state.next_round = dataclasses.replace(plan, counts_sha256=counts_sha256)

    def render_round(self, plan):
        """Renders the parts of a round that are not in the journal yet."""
        for half, index in itertools.product(HALVES, range(plan.parts)):
            index_in_round = plan.parts_before + index
            if self.state.part_count(plan.round, half) <= index_in_round:
                self.announce(f"round {plan.round}, half {half.upper()}", round=plan.round)
                counts = self._counts(plan, half)
                if not counts.any():  # The samples of this round are all the other half's.
                    continue
                first_sample = plan.first_samples[half] + index * int(counts.max())
                weighted = plan.cost_weighted_samples / len(HALVES)
                self._render_part(
                    plan.round, half, index_in_round, first_sample, counts=counts, cost_weighted_samples=weighted
                )
        self.state.next_round = None
        self.journal.save()

    def _render_part(self, round_number, half, index, first_sample, samples=0, counts=None, cost_weighted_samples=0.0):
        """Renders `samples` of every pixel or, where given, `counts`. `cost_weighted_samples` are those of a masked
        part."""
        target = self.folder.part(round_number, half, index)
        begin = time.monotonic()
        if counts is None:
            self.renderer.uniform(first_sample, samples, target)
        else:
            samples = int(counts.max())
            self.renderer.extra(first_sample, counts, target)
        seconds = time.monotonic() - begin
        taken = read_taken(target)
        most = int(taken.counts.max())
        if not most or (most > samples and (counts is None or self.renderer.extra_in_sequence)):
            raise DriverError(
                ExitCode.RENDERER, f"{target}: the renderer took {most} samples of a pixel, not 1 to {samples}"
            )
        self._add(half, taken)
        mean = float(taken.counts.mean())
        masked = counts is not None and bool(counts.min() < counts.max())
        self.state.parts.append(
            Part(
                file=target.name,
                half=half,
                round=round_number,
                first_sample=first_sample,
                samples=mean,
                cost_weighted_samples=cost_weighted_samples if masked else mean,
                seconds=seconds,
                masked=masked,
                sha256=digest(target),
            )
        )
        self.state.next_sample = max(self.state.next_sample, first_sample + max(samples, most))
        self.journal.save()

    def _counts(self, plan, half):
        """Counts of each part of a half, from their file."""
        file = self.folder.in_round(plan.round, f"counts_{half}")
        counts = exr.read(file)["samples.Y"].astype(int)
        if counts.shape != self.taken[half].counts.shape or (counts < 0).any() or (counts % plan.parts).any():
            raise DriverError(
                ExitCode.BAD_INPUT, f"{file}: holds no counts of this frame: start again with another --passes-dir"
            )
        return counts // plan.parts

    def _check(self, part, taken):
        """Raises an error unless the file of a part holds the samples that the journal states."""
        if not np.isclose(part.samples, taken.counts.mean()) or part.first_sample + taken.counts.max() > (
            self.state.next_sample
        ):
            raise DriverError(
                ExitCode.BAD_INPUT,
                f"{self.journal.path}: contradicts the samples of {part.file}: start again with another --passes-dir",
            )

    def _add(self, half, taken):
        taken = dataclasses.replace(taken, counts=taken.counts.astype(float))
        before = self.taken.get(half)
        if before and before.counts.shape != taken.counts.shape:
            raise DriverError(
                ExitCode.RENDERER, f"{self.folder.path}: parts differ in size: start again with another --passes-dir"
            )
        self.taken[half] = before + taken if before else taken


def read_taken(part):
    """The samples of a part, read from its file."""
    channels = exr.read(part, lambda name: name.endswith((SAMPLE_COUNT, RENDER_SECONDS)))
    counts, seconds = (
        next((values for name, values in channels.items() if name.endswith(wanted)), None)
        for wanted in (SAMPLE_COUNT, RENDER_SECONDS)
    )
    if counts is None:
        raise DriverError(ExitCode.RENDERER, f"{part}: the renderer wrote no {SAMPLE_COUNT}")
    if not np.isfinite(counts).all() or counts.min() < 0:
        raise DriverError(ExitCode.RENDERER, f"{part}: {SAMPLE_COUNT} holds values that are no counts")
    return Taken(counts, seconds)
