"""Decisions about the samples of a round: pure functions of the state and of maps in memory. They run nothing and write
no file."""

import numpy as np

from .budget import CONVERGENCE_RATE, Spent
from .counts import weight_of_samples
from .journal import HALVES, RoundPlan

# Number of parts that a half of a uniform round is divided into: the variance is measured by their difference. More
# parts take longer, since a sample of a long pass is cheaper than one of a short pass
# (docs/lab/2026-11-27-loop-seconds.md).
UNIFORM_PARTS = 2
MIN_DIVIDED = 8  # Samples of a half that are divided at all

# Steps of the budget that a uniform round takes at once: the next sample map will not pay any sooner.
UNIFORM_STEPS = 3

# Seconds of a sample in a masked pass over those of a sample in a uniform pass, until the frame has masked passes
# (docs/lab/2026-11-27-loop-seconds.md).
MASKED_OVER_UNIFORM = 1.3


def first_pass_parts(samples, budget):
    """Number of parts of the first pass, both halves together. With a budget of seconds, more uniform parts follow,
    which suffice to measure the variance. One part for each half saves the overhead of short parts then."""
    if budget.seconds:
        return len(HALVES)
    return samples // 2 if samples > 8 and samples % 4 == 0 else samples


def what_is_spent(state, seconds, decision_seconds, result_over_decision):
    """result_over_decision: seconds of the result over those of a decision."""
    return Spent(
        samples=state.samples,
        cost_weighted_samples=sum(part.cost_weighted_samples for part in state.parts),
        seconds=seconds,
        seconds_per_sample=seconds_per_uniform_sample(state.parts) * masked_over_uniform(state.parts),
        decision_seconds=decision_seconds,
        result_seconds=decision_seconds * result_over_decision,
    )


def seconds_per_uniform_sample(parts):
    """Seconds of one sample in every pixel. Parts less than half as long as the longest are left out, as their samples
    are dearer than the next ones will be. The others count together, since a renderer may take several parts in one go
    and attribute its seconds to the first."""
    uniform = [part for part in parts if not part.masked]
    longest = max(part.samples for part in uniform)
    long = [part for part in uniform if part.samples >= longest / 2]
    return sum(part.seconds for part in long) / sum(part.samples for part in long)


def masked_over_uniform(parts):
    """Seconds of a sample of average cost in a masked pass over those in a uniform pass; at least 1."""
    masked, uniform = ([part for part in parts if part.masked is kind] for kind in (True, False))
    if not masked:
        return MASKED_OVER_UNIFORM
    return max(1.0, _seconds_per_weighted_sample(masked) / _seconds_per_weighted_sample(uniform))


def _seconds_per_weighted_sample(parts):
    return sum(part.seconds for part in parts) / sum(part.cost_weighted_samples for part in parts)


def uniform_samples(budget, parts, samples):
    """Uniform samples that take as long as `samples` of a masked round; as many where seconds do not count."""
    return samples * (1 if budget.samples else masked_over_uniform(parts))


def uniform_counts(shape, parts, samples):
    """Counts of each half for a uniform round of so many samples, rounded down to what its parts can be divided
    into."""
    each = max(0, int(samples / 2))
    counts = np.full(shape, each - each % _uniform_parts(parts, each))
    return dict.fromkeys(HALVES, counts)


def _uniform_parts(parts, samples):
    """Number of parts for so many uniform samples of a half. Where the half has enough parts that are as long, the
    variance is known from these already."""
    as_long = sum(part.half == "a" and not part.masked and part.samples >= samples for part in parts)
    return UNIFORM_PARTS if samples >= MIN_DIVIDED and as_long < UNIFORM_PARTS else 1


def map_pays(error_maps, taken, counts, uniform):
    """Whether the counts leave less error than `uniform` samples, which take as long, would. The counts of each half
    are tried on that half's own error map. They were made from the other half's, so the noise of a map promises no
    gain.

    error_maps: of each half, {channel: array}. taken: of each half. counts: of each half."""
    error_left = {"map": 0.0, "uniform": 0.0}
    for half in HALVES:
        weight = weight_of_samples(error_maps[half]["relvariance.Y"], error_maps[half]["relnoise.Y"])
        before = np.maximum(taken[half].counts, 1)
        for way, extra in (("map", counts[half]), ("uniform", uniform / 2)):
            error_left[way] += float((weight * (before / (before + extra)) ** CONVERGENCE_RATE).sum())
    return error_left["map"] <= error_left["uniform"]


def plan_round(state, number, counts, cost_weighted_samples):
    """Places the counts of both halves in the sequence. Counts that differ between pixels begin at a multiple of the
    largest one, so that every count is a whole block of the sequence; uniform counts begin at the next free number."""
    uniform = all(values.min() == values.max() for values in counts.values())
    first_samples, free = {}, state.next_sample
    for half in HALVES:
        most = max(1, int(counts[half].max()))
        first_samples[half] = free if uniform else -(-free // most) * most
        free = first_samples[half] + most
    return RoundPlan(
        round=number,
        first_samples=first_samples,
        parts=min(_uniform_parts(state.parts, int(values.max())) for values in counts.values()) if uniform else 1,
        parts_before=state.part_count(number, "a"),
        cost_weighted_samples=cost_weighted_samples,
        counts_sha256={},
    )
