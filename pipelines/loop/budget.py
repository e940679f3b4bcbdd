"""How much is spent, and how much the next round may take."""

import dataclasses
import math
from typing import Optional

GROWTH = 1.0  # a round takes as much as was spent before it, so the slices double
LEAST_SAMPLES = 0.25  # per pixel: a smaller round does not pay its overhead
EVEN_SHARE = 0.25  # of a budget of seconds, spent evenly before anything is judged: see even_share
MOST_JUDGING = 0.05  # of a round's seconds, where seconds are the budget: fewer and larger rounds where judging is dear
CONVERGENCE_RATE = 0.75  # the error falls with n^-this: src/maps/sample_map.h
SAMPLES_SPENT, SECONDS_SPENT = "the samples are spent", "the seconds are spent"


@dataclasses.dataclass(frozen=True)
class Budget:
    """Exactly one is set."""

    samples: Optional[float] = None  # per pixel on average, the first pass among them
    seconds: Optional[float] = None  # of everything, from the start of the driver to the result
    target: Optional[float] = None  # mean relative MSE of the result

    def __str__(self):
        if self.samples:
            return f"{self.samples:g} samples per pixel"
        return f"{self.seconds:g} s" if self.seconds else f"relative MSE {self.target:g}"


@dataclasses.dataclass
class Spent:
    """samples: per pixel. worth: the same in samples of average cost. seconds: of everything. seconds_per_sample: of the next
    ones, of average cost. judging: seconds of the last decision, reconstructions and maps. reserve: seconds that the result
    still needs. error: estimated mean relative MSE of the result."""

    samples: float
    seconds: float
    worth: float
    seconds_per_sample: float
    judging: float
    reserve: float
    error: float = math.nan


def seconds_per_even_sample(parts):
    """From a journal's parts without masks. Short ones are dearer than the next will be; the others count together, since a
    renderer may take several of them in one go and put its seconds down to the first."""
    even = [part for part in parts if not part["masked"]]
    longest = max(part["spp"] for part in even)
    long = [part for part in even if part["spp"] >= longest / 2]
    return sum(part["seconds"] for part in long) / sum(part["spp"] for part in long)


def even_share(budget, spent):
    """Samples per pixel that are spent evenly after the first pass, where seconds are the budget. No pixel of a good map has
    fewer than such a share, so they are not spent in vain, and the first judgement, which is dear where the seconds
    count, then knows more than that of a few samples would. Where no judgement would pay after that, all that is left."""
    after = max(spent.seconds, EVEN_SHARE * budget.seconds)
    if nothing_left(budget, dataclasses.replace(spent, seconds=after)):
        return rest(budget, spent)
    return (after - spent.seconds) / max(spent.seconds_per_sample, 1e-9)


def nothing_left(budget, spent):
    """Why no further round is judged, where that is known before; else ''. One of which the judging takes more than its share
    of the seconds does not pay."""
    if budget.samples and budget.samples - spent.samples < LEAST_SAMPLES:
        return SAMPLES_SPENT
    if budget.seconds and _seconds_left(budget, spent) < spent.judging / MOST_JUDGING:
        return SECONDS_SPENT
    return ""


def rest(budget, spent):
    """Samples per pixel for the seconds that are left when nothing more is judged."""
    return _seconds_left(budget, spent) / max(spent.seconds_per_sample, 1e-9) if budget.seconds else 0.0


def next_slice(budget, spent, steps=1):
    """Samples per pixel of the next round, and why there is none (or ''). The slices grow geometrically; the last one takes
    what is left, and one that would leave no more than itself takes that too. steps: so many slices at once."""
    step = GROWTH * spent.worth
    if budget.samples:
        left, reason = budget.samples - spent.samples, SAMPLES_SPENT
    elif budget.seconds:
        left, reason = rest(budget, spent), SECONDS_SPENT
        step = max(step, spent.judging / MOST_JUDGING / max(spent.seconds_per_sample, 1e-9))
    elif spent.error <= budget.target:
        return 0.0, f"the target is reached: {spent.error:.3g}"
    else:
        left, reason = _needed(budget.target, spent), ""
    if left < LEAST_SAMPLES:
        return 0.0, reason
    step *= steps
    return (left if left <= 2 * step else step), ""


def _seconds_left(budget, spent):
    return budget.seconds - spent.seconds - spent.reserve


def _needed(target, spent):
    """More samples per pixel until error (n / (n + dn))^CONVERGENCE_RATE is the target."""
    return max(LEAST_SAMPLES, spent.worth * ((spent.error / target) ** (1 / CONVERGENCE_RATE) - 1))
