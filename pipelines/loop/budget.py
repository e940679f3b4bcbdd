"""How many samples the next round takes: from a budget and what is spent."""

import dataclasses
import math
from typing import Optional

# A round takes this multiple of all cost-weighted samples before it. With 1, the samples double each round.
GROWTH = 1.0

MIN_SAMPLES = 0.25  # Per pixel: a smaller round does not pay for its overhead.

# Share of a budget of seconds that is spent on uniform samples before the first decision. Almost no pixel of a good
# sample map has fewer samples than that, so they are not wasted, and one early decision less saves its seconds
# (docs/lab/2026-11-27-loop-seconds.md).
UNIFORM_SHARE = 0.25

# Most seconds of a decision over the seconds that are left for rounds. Where decisions are slow, rounds are fewer and
# larger.
MAX_DECISION_SHARE = 0.05

# The error falls with n^-CONVERGENCE_RATE, n being the samples per pixel: convergence_rate of
# include/polyrecon/sample_map.h. tests/pipelines/loop/test_counts.py compares the two.
CONVERGENCE_RATE = 0.75

# Seconds of the last merge, the last reconstruction and the report over the seconds of a decision, for each --quality.
# By hand, 2026-11-28. To check: seconds after the last part of a run over decision_seconds in its journal.json.
RESULT_OVER_DECISION = {"draft": 0.8, "standard": 1.9, "best": 4.4}
# The same of --with-prior (docs/lab/2026-12-01-prior-in-the-loop.md).
PRIOR_OVER_DECISION = {"draft": 1.1, "standard": 2.0, "best": 2.0}

SAMPLES_SPENT, SECONDS_SPENT = "the samples are spent", "the seconds are spent"


@dataclasses.dataclass(frozen=True)
class Budget:
    """Exactly one of the three is set."""

    samples: Optional[float] = None  # Per pixel, mean of the frame; the first pass counts.
    seconds: Optional[float] = None  # From the start of the loop to the result
    target: Optional[float] = None  # Mean relative MSE of the result

    def __str__(self):
        if self.samples:
            return f"{self.samples:g} samples per pixel"
        return f"{self.seconds:g} s" if self.seconds else f"relative MSE {self.target:g}"


@dataclasses.dataclass(frozen=True)
class Spent:
    """Samples and seconds that a frame took so far, and that its next steps are expected to take."""

    samples: float  # Per pixel, mean of the frame
    cost_weighted_samples: float  # The same, counted in samples of average cost
    seconds: float  # In all
    seconds_per_sample: float  # Expected for one more sample of average cost in every pixel
    decision_seconds: float  # For a decision: both reconstructions and the sample maps
    result_seconds: float  # That the result still needs
    error: float = math.nan  # Estimated mean relative MSE of the result


def result_over_decision(quality, with_prior):
    """Seconds of the result over those of a decision."""
    return RESULT_OVER_DECISION[quality] + (PRIOR_OVER_DECISION[quality] if with_prior else 0.0)


def uniform_share(budget, spent):
    """Samples per pixel that follow the first pass uniformly, for a budget of seconds. The first decision then knows
    more than the few samples of the first pass would show. Where no decision pays after that, the samples take all
    seconds that are left. Not above 0: none."""
    after = max(spent.seconds, UNIFORM_SHARE * budget.seconds)
    if reason_to_stop(budget, dataclasses.replace(spent, seconds=after)):
        return samples_left(budget, spent)
    return (after - spent.seconds) / max(spent.seconds_per_sample, 1e-9)


def reason_to_stop(budget, spent):
    """Why no further decision is made, as far as that is known without one; '' where one is made. A decision that takes
    more than MAX_DECISION_SHARE of the seconds that are left does not pay."""
    if budget.samples and budget.samples - spent.samples < MIN_SAMPLES:
        return SAMPLES_SPENT
    if budget.seconds and _seconds_left(budget, spent) < spent.decision_seconds / MAX_DECISION_SHARE:
        return SECONDS_SPENT
    return ""


def samples_left(budget, spent):
    """Samples per pixel for all seconds that are left; 0 where the budget is not in seconds."""
    return _seconds_left(budget, spent) / max(spent.seconds_per_sample, 1e-9) if budget.seconds else 0.0


def samples_of_next_round(budget, spent, steps=1):
    """(cost-weighted samples per pixel, reason): the next round takes `steps` times the step of a geometric growth. If
    less than two rounds' budget remains, it takes all of it. 0 samples: the loop ends, for the reason."""
    step = GROWTH * spent.cost_weighted_samples
    if budget.samples:
        left, reason = budget.samples - spent.samples, SAMPLES_SPENT
    elif budget.seconds:
        left, reason = samples_left(budget, spent), SECONDS_SPENT
        step = max(step, spent.decision_seconds / MAX_DECISION_SHARE / max(spent.seconds_per_sample, 1e-9))
    elif spent.error <= budget.target:
        return 0.0, f"the target is reached: {spent.error:.3g}"
    else:
        left, reason = _samples_to_target(budget.target, spent), ""
    if left < MIN_SAMPLES:
        return 0.0, reason
    step *= steps
    return (left if left <= 2 * step else step), ""


def _seconds_left(budget, spent):
    return budget.seconds - spent.seconds - spent.result_seconds


def _samples_to_target(target, spent):
    """More samples per pixel, dn, until error (n / (n + dn))^CONVERGENCE_RATE is the target."""
    return max(MIN_SAMPLES, spent.cost_weighted_samples * ((spent.error / target) ** (1 / CONVERGENCE_RATE) - 1))
