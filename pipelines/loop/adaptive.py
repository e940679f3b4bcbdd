"""The adaptive loop: a first uniform pass, then rounds of (reconstruct, error map, sample map, extra samples), then the
result.

No bias: every pixel has two halves of samples, A and B. Where A's next samples go is decided from B's samples alone and the
other way round, and the picture is (mean of A + mean of B) / 2. A pixel that came out bright by chance thus does not draw
the samples that would dilute it, as it would if one and the same set of samples were judged and refined (docs/adaptive.md).
"""

import dataclasses
import itertools
import os
import pathlib
import time
from typing import Optional

import numpy as np

from ..common import exr
from ..common.errors import DriverError, ExitCode
from .budget import CONVERGENCE_RATE, Budget, Spent, even_share, next_slice, nothing_left, rest, seconds_per_even_sample
from .counts import cost_of_samples, quantise, weight_of_samples
from .journal import Journal
from .renderer import RENDER_SECONDS, SAMPLE_COUNT

HALVES = ("a", "b")
OTHER = {"a": "b", "b": "a"}
ROUND_QUALITY = "draft"
EVEN_PARTS = 2  # of a half in an even round: what they differ by tells the variance; the longer, the cheaper a sample
LEAST_CUT, LEAST_EVEN = 8, 1  # samples of a half that are cut so, and that are worth a pass
EVEN_STEPS = 3  # slices that an even round takes at once: it is not as soon that another map pays
# Seconds of a sample in a masked pass over one in a whole pass, until measured: docs/lab/2026-11-27-loop-seconds.md.
EXTRA_OVER_UNIFORM = 1.3
# Seconds of a decision over those of merging two parts, until one was made: within a fifth from 480x270 to 1920x1080.
JUDGING = 8.5
# Seconds of the last merge and reconstruction, of all samples, and of the report, over those of a decision.
LAST_OVER_ROUND = {"draft": 0.8, "standard": 1.9, "best": 4.4}


@dataclasses.dataclass
class Settings:
    output: pathlib.Path
    passes: pathlib.Path  # the frame's own folder
    budget: Budget
    frame: Optional[int] = None
    first_pass: int = 8
    max_rounds: int = 8
    quality: str = "standard"
    resume: bool = False
    identity: dict = dataclasses.field(default_factory=dict)  # of the scene: see Journal


@dataclasses.dataclass
class Result:
    audit: object
    renderer: str
    journal: Journal
    merged: pathlib.Path
    error_map: pathlib.Path
    error: float  # estimated mean relative MSE
    samples: float
    seconds: float
    why_ended: str


class _Totals:
    """Samples taken of each pixel, and the seconds that they took, over a half's parts."""

    def __init__(self, counts=0.0, seconds=0.0):
        self.counts, self.seconds = counts, seconds

    def __add__(self, other):
        known = self.seconds is not None and other.seconds is not None
        return _Totals(self.counts + other.counts, self.seconds + other.seconds if known else None)

    def add(self, part):
        """Adds a part's file; returns its counts."""
        channels = exr.read(part, lambda name: name.endswith((SAMPLE_COUNT, RENDER_SECONDS)))
        values = {
            name: next((v for n, v in channels.items() if n.endswith(name)), None)
            for name in (SAMPLE_COUNT, RENDER_SECONDS)
        }
        if values[SAMPLE_COUNT] is None:
            raise DriverError(ExitCode.RENDERER, f"{part}: the renderer wrote no {SAMPLE_COUNT}")
        total = self + _Totals(values[SAMPLE_COUNT].astype(float), values[RENDER_SECONDS])
        self.counts, self.seconds = total.counts, total.seconds
        return values[SAMPLE_COUNT]


def run(renderer, polyrecon, settings, progress):
    """Runs the loop for one frame; returns a Result. Raises DriverError; the passes so far can then be resumed."""
    return _Loop(renderer, polyrecon, settings, progress).run()


class _Loop:
    def __init__(self, renderer, polyrecon, settings, progress):
        self.renderer, self.polyrecon, self.settings, self.progress = renderer, polyrecon, settings, progress
        self.folder = settings.passes
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise DriverError(ExitCode.OUTPUT, f"{self.folder}: {error.strerror}") from error
        identity = {**settings.identity, "frame": settings.frame, "first_pass": settings.first_pass}
        self.journal = Journal.open(self.folder, identity, settings.resume)
        if self.journal["rounds"] and not self.journal["rounds"][-1]["extra"]:
            self.journal["rounds"].pop()  # it ended there; judged again, by the budget of today
        for stale in self.folder.rglob(".*.exr"):  # of a run that was killed while it wrote
            stale.unlink()
        self.started = time.monotonic() - self.journal["seconds"]
        self.totals = {half: _Totals() for half in HALVES}
        for part in self.journal["parts"]:
            self.totals[part["half"]].add(self.folder / part["file"])
        self.journal["first_parts"] = self.journal["first_parts"] or self.first_parts()
        self.why_ended = ""
        self.judging = None  # seconds of the last round's decision: both halves' reconstruction and maps

    def run(self):
        self.audit = self.renderer.begin(self.settings.frame)
        self.uniform_pass()
        if self.settings.budget.seconds:
            self.foresee_judging()
            self.even_pass()
        while plan := self.journal["plan"] or self.plan_round():
            self.render_round(plan)
        return self.finish()

    # The passes.

    def uniform_pass(self):
        """The first samples of the sequence as parts of their own, the first half of them being A: each half is a block of
        the sequence, which is better spread than every other sample would be."""
        parts = self.journal["first_parts"]
        each = self.settings.first_pass // parts
        for index in range(parts):
            half = HALVES[index * 2 // parts]
            place = index % (parts // 2)
            if not self.journal.has(0, half, place):
                self.tell("first pass", done=index / parts)
                self.render_part(0, half, place, index * each, None, each)
        self.journal["next"] = max(self.journal["next"], self.settings.first_pass)

    def first_parts(self):
        """How many to cut the first pass into. Where seconds are the budget, even parts follow that tell the variance: one for
        each half then, as short ones are dear."""
        samples = self.settings.first_pass
        if self.settings.budget.seconds:
            return len(HALVES)
        return samples // 2 if samples > 8 and samples % 4 == 0 else samples

    def foresee_judging(self):
        """What a decision will take, from how long it takes to merge the halves' first parts."""
        merged = self.file(0, "first")
        merged.parent.mkdir(exist_ok=True)
        begin = time.monotonic()
        self.polyrecon.run(
            "merge", *[self.journal.files(half)[0] for half in HALVES], "-o", merged, "--compression", "none", "--quiet"
        )
        self.judging = JUDGING * (time.monotonic() - begin)
        merged.unlink()

    def even_pass(self):
        """Goes on with the first pass where even_share says so."""
        if self.journal["rounds"] or self.journal["plan"] or len(self.journal["parts"]) > self.journal["first_parts"]:
            return
        if plan := self.plan_even(0, self.even_samples(even_share(self.settings.budget, self.spent()))):
            self.render_round(plan)

    def plan_even(self, number, samples):
        """The same samples of every pixel as (a further part of) a round; None where they are too few."""
        counts = {half: self.even_counts(samples) for half in HALVES}
        most = int(counts["a"].max())
        if most < LEAST_EVEN:
            return None
        self.journal["plan"] = {**self.place_in_sequence(number, counts), "worth": 2 * most}
        return self.journal["plan"]

    def render_round(self, plan):
        for half, index in itertools.product(HALVES, range(plan["parts"])):
            place = plan["before"] + index
            if not self.journal.has(plan["round"], half, place):
                self.tell(f"round {plan['round']}, half {half.upper()}", round=plan["round"])
                counts = (
                    next(iter(exr.read(self.file(plan["round"], f"counts_{half}")).values())).astype(int)
                    // plan["parts"]
                )
                first = plan["first"][half] + index * int(counts.max())
                self.render_part(plan["round"], half, place, first, counts, 0, plan["worth"] / 2)
        self.journal["plan"] = None
        self.journal.save()

    def render_part(self, round_number, half, index, first, counts, samples, worth=None):
        name = f"part_{round_number}{half}{index}.exr"
        begin = time.monotonic()
        if counts is None:
            self.renderer.uniform(first, samples, self.folder / name)
        else:
            samples = self.renderer.extra(first, counts, self.folder / name)
        seconds = time.monotonic() - begin
        taken = self.totals[half].add(self.folder / name)
        part = {
            "file": name,
            "half": half,
            "round": round_number,
            "first": first,
            "spp": float(taken.mean()),
            "seconds": seconds,
        }
        part["masked"] = counts is not None and int(counts.min()) < int(counts.max())
        part["worth"] = worth if part["masked"] else part["spp"]  # samples of average cost
        self.journal["parts"].append(part)
        self.journal["next"] = max(self.journal["next"], first + samples)
        self.save()

    # One round's decision.

    def plan_round(self):
        """Reconstructs both halves and decides where the next samples of each go; None where the loop ends."""
        number = len(self.journal["rounds"])
        (self.folder / f"round_{number}").mkdir(exist_ok=True)
        if self.judging is not None:
            spent = self.spent()
            self.why_ended = nothing_left(self.settings.budget, spent)
            if self.why_ended:
                if not number:
                    self.why_ended += ", too few of them to judge where samples should go"
                return self.plan_even(number + 1, self.even_samples(rest(self.settings.budget, spent)))
        self.reconstruct_halves(number)
        begin = time.monotonic()
        spent = dataclasses.replace(self.spent(), error=self.error_of_mean(number))
        samples, self.why_ended = next_slice(self.settings.budget, spent)
        if samples and number >= self.settings.max_rounds:
            samples, self.why_ended = 0.0, f"{number} rounds are done (--max-rounds)"
        counts = self.counts_for(number, samples) if samples else {}
        if samples and not counts:
            samples, _ = next_slice(self.settings.budget, spent, EVEN_STEPS)
            counts = {half: self.even_counts(self.even_samples(samples)) for half in HALVES}
        self.judging += time.monotonic() - begin
        if samples and not any(c.any() for c in counts.values()):
            self.why_ended = "no error is left that more samples could lower"
            samples = 0.0
        entry = {
            "round": number,
            "spp": spent.samples,
            "seconds": spent.seconds,
            "judging": self.judging,
            "error": spent.error,
        }
        entry["extra"] = samples
        self.journal["rounds"].append(entry)
        if samples:
            self.journal["plan"] = {**self.place_in_sequence(number + 1, counts), "worth": samples}
        self.save()
        return self.journal["plan"]

    def reconstruct_halves(self, number):
        """Both at a time, each on half of the processors: a frame of a draft keeps several less busy than two frames do."""
        self.tell(f"reconstruction {number}", round=number)
        begin = time.monotonic()
        self.merge_halves(number)
        files = {
            half: [self.file(number, f"{kind}_{half}") for kind in ("merged", "clean", "error")] for half in HALVES
        }
        completing = time.monotonic()
        for merged, _, _ in files.values():
            self.renderer.complete(merged)
        begin += time.monotonic() - completing  # it may render feature passes, once: no later judgement takes as long
        threads = max(1, len(os.sched_getaffinity(0)) // 2)
        self.polyrecon.run_side_by_side(
            "denoise",
            [
                [
                    "-i",
                    merged,
                    "-o",
                    clean,
                    "--quality",
                    ROUND_QUALITY,
                    "--error-map",
                    error,
                    "--threads",
                    threads,
                    "--quiet",
                ]
                for merged, clean, error in files.values()
            ],
        )
        self.judging = time.monotonic() - begin

    def merge_halves(self, number):
        self.polyrecon.run_side_by_side(
            "merge",
            [
                [
                    *self.journal.files(half),
                    "-o",
                    self.file(number, f"merged_{half}"),
                    "--compression",
                    "none",
                    "--quiet",
                ]
                for half in HALVES
            ],
        )

    def spent(self):
        parts = self.journal["parts"]
        return Spent(
            samples=sum(p["spp"] for p in parts),
            seconds=self.seconds(),
            worth=sum(p["worth"] for p in parts),
            seconds_per_sample=seconds_per_even_sample(parts) * self.extra_over_uniform(),
            judging=self.judging,
            reserve=self.judging * (LAST_OVER_ROUND[self.settings.quality] + self.renderer.last_over_round),
        )

    def error_of_mean(self, number):
        """Joins what the halves tell: pictures for the report, and the error of a reconstruction of both halves, which
        have twice the samples of one."""
        halves = [exr.read(self.file(number, f"error_{half}")) for half in HALVES]
        error = sum(h["relmse.Y"] for h in halves) / 2 * 2**-CONVERGENCE_RATE
        exr.write(self.file(number, "error"), {"relmse.Y": error})
        for kind, name in (("merged", "noisy"), ("clean", "clean")):
            files = [self.picture(self.file(number, f"{kind}_{half}")) for half in HALVES]
            exr.write(self.file(number, name), {c: (files[0][c] + files[1][c]) / 2 for c in files[0]})
            for half in HALVES:
                self.file(number, f"{kind}_{half}").unlink()
        return float(np.nanmean(error))

    def counts_for(self, number, samples):
        """Counts of each half's next samples, from the other half's error map and costs, half of the slice for each; none
        where they would not pay."""
        costs = {half: self.cost(self.totals[OTHER[half]]) for half in HALVES}
        files = {half: [self.file(number, f"{kind}_{half}") for kind in ("cost", "map")] for half in HALVES}
        for half, (cost_file, _) in files.items():
            exr.write(cost_file, {"Y": costs[half]})
        self.polyrecon.run_side_by_side(
            "samplemap",
            [
                [
                    "--error-map",
                    self.file(number, f"error_{OTHER[half]}"),
                    "--budget",
                    samples / 2,
                    "--max-samples",
                    max(1024, 4 * samples),
                    "--cost",
                    cost_file,
                    "-o",
                    map_file,
                    "--quiet",
                ]
                for half, (cost_file, map_file) in files.items()
            ],
        )
        counts = {half: quantise(exr.read(map_file)["samples.Y"], costs[half]) for half, (_, map_file) in files.items()}
        for file in itertools.chain(*files.values()):
            file.unlink()
        return counts if self.even_samples(samples) < 2 or self.map_pays(number, counts, samples) else {}

    def map_pays(self, number, counts, samples):
        """Whether the counts lower the error by more than as many seconds of uniform samples would. Each half's counts are
        tried on its own error map, which they were not made from: the noise of a map promises no gain that way."""
        left = {"map": 0.0, "even": 0.0}
        for half in HALVES:
            error = exr.read(self.file(number, f"error_{half}"))
            weight = weight_of_samples(error["relvariance.Y"], error["relnoise.Y"])
            taken = np.maximum(self.totals[half].counts, 1)
            for way, extra in (("map", counts[half]), ("even", self.even_samples(samples) / 2)):
                left[way] += float((weight * (taken / (taken + extra)) ** CONVERGENCE_RATE).sum())
        return left["map"] <= left["even"]

    def even_samples(self, samples):
        """Uniform samples for the seconds of a round's slice."""
        return samples * (1 if self.settings.budget.samples else self.extra_over_uniform())

    def even_counts(self, samples):
        """Of a half; a multiple of the parts that they can be cut into."""
        each = max(0, int(samples / 2))
        return np.full(self.totals["a"].counts.shape, each - each % self.even_parts(each))

    def even_parts(self, samples):
        """How many to cut so many even samples of a half into: what parts differ by tells the variance, so not where others
        that are as long do."""
        as_long = sum(p["half"] == "a" and not p["masked"] and p["spp"] >= samples for p in self.journal["parts"])
        return EVEN_PARTS if samples >= LEAST_CUT and as_long < EVEN_PARTS else 1

    def extra_over_uniform(self):
        """What a sample (of average cost) of a masked pass takes, over one of a whole pass."""
        seconds = {masked: [p for p in self.journal["parts"] if p["masked"] is masked] for masked in (False, True)}
        if not seconds[True]:
            return EXTRA_OVER_UNIFORM
        masked, whole = (
            sum(p["seconds"] for p in parts) / sum(p["worth"] for p in parts)
            for parts in (seconds[True], seconds[False])
        )
        return max(1.0, masked / whole)

    def place_in_sequence(self, number, counts):
        """A half's counts that differ begin at a multiple of the largest, so that every count is a whole block of the sequence;
        even ones go on where the sequence has come to."""
        even = all(c.min() == c.max() for c in counts.values())
        parts = min(self.even_parts(int(c.max())) for c in counts.values()) if even else 1
        before = (
            sum(part["round"] == number for part in self.journal["parts"]) // 2
        )  # parts of a half that the round has
        plan = {"round": number, "first": {}, "parts": parts, "before": before}
        free = self.journal["next"]
        (self.folder / f"round_{number}").mkdir(exist_ok=True)
        for half in HALVES:
            most = max(1, int(counts[half].max()))
            plan["first"][half] = free if even else -(-free // most) * most
            free = plan["first"][half] + most
            exr.write(self.file(number, f"counts_{half}"), {"samples.Y": counts[half]})
        exr.write(self.file(number, "samples"), {"samples.Y": counts["a"] + counts["b"]})
        return plan

    # The result.

    def finish(self):
        merged, error_map = self.folder / "merged.exr", self.folder / "error.exr"
        self.tell("result", done=1.0)
        halves = [self.journal.files(half) for half in HALVES]
        self.polyrecon.run(
            "merge", *halves[0], "--half-b", *halves[1], "-o", merged, "--compression", "none", "--quiet"
        )
        self.renderer.complete(merged)
        self.renderer.complete_last(merged)
        self.polyrecon.run(
            "denoise",
            "-i",
            merged,
            "-o",
            self.settings.output,
            "--quality",
            self.settings.quality,
            "--error-map",
            error_map,
            "--quiet",
        )
        self.save()
        error = float(np.nanmean(exr.read(error_map, lambda name: name == "relmse.Y")["relmse.Y"]))
        samples = sum(p["spp"] for p in self.journal["parts"])
        return Result(
            self.audit,
            self.renderer.name,
            self.journal,
            merged,
            error_map,
            error,
            samples,
            self.seconds(),
            self.why_ended,
        )

    # Small things.

    def file(self, number, name):
        return self.folder / f"round_{number}" / f"{name}.exr"

    def seconds(self):
        return time.monotonic() - self.started

    def save(self):
        self.journal["seconds"] = self.seconds()
        self.journal.save()

    def cost(self, totals):
        """What a sample of each pixel costs, in the budget's own currency: where samples are counted, all are alike."""
        return cost_of_samples(None if self.settings.budget.samples else totals.seconds, totals.counts)

    def picture(self, path):
        prefix = f"{self.audit.beauty}." if self.audit.beauty else ""
        channels = exr.read(path, lambda name: name in {prefix + c for c in "RGB"})
        return {c: channels[prefix + c] for c in "RGB"}

    def tell(self, stage, **figures):
        budget, last = self.settings.budget, (self.journal["rounds"] or [{}])[-1]
        samples = sum(p["spp"] for p in self.journal["parts"])
        done = (
            samples / budget.samples if budget.samples else self.seconds() / budget.seconds if budget.seconds else None
        )
        left = budget.seconds - self.seconds() if budget.seconds else None
        self.progress.update(
            stage,
            **{
                "frame": self.settings.frame,
                "samples": samples,
                "error": last.get("error"),
                "seconds": round(self.seconds(), 2),
                "seconds_left": left,
                "done": done,
                **figures,
            },
        )
