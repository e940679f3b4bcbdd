"""How the frames of a shot share what is left of its budget: pure functions of figures. They run nothing."""

import dataclasses

from .budget import CONVERGENCE_RATE, GROWTH, MIN_SAMPLES

# A round takes at least this share of what the frame has taken before: each round has fixed costs.
MIN_GROWTH = 0.125


@dataclasses.dataclass(frozen=True)
class Figures:
    """What is known of a frame."""

    error: float  # Expected mean relative MSE of the result, or any other unit that is the same for all frames
    spent: float  # What its samples took, in units of the budget: seconds, or samples per pixel; above 0
    price: float  # Of one more sample per pixel, in units of the budget
    overhead: float = 0.0  # A round below so many units does not pay for the decision before it.

    @property
    def least(self):
        """The smallest round, in units of the budget."""
        return max(MIN_SAMPLES * self.price, MIN_GROWTH * self.spent)

    @property
    def step(self):
        """The usual round, in units of the budget."""
        return max(GROWTH * self.spent, self.overhead)

    @property
    def gain(self):
        """Fall of the error for a unit of the budget. error (spent / (spent + d))^CONVERGENCE_RATE is expected after d
        more units."""
        return CONVERGENCE_RATE * self.error / self.spent

    def error_after(self, more):
        return self.error * (self.spent / (self.spent + more)) ** CONVERGENCE_RATE


def shares_of(frames, left):
    """What each frame gets of `left`, so that the sum of the expected errors is least.

    The gains of all frames that get something are then equal: with one level for all of them,
    spent + share = level (error spent^rate)^(1 / (1 + rate)). A frame without error gets nothing, and neither does one
    whose gain is below that of the others already."""
    pull = [(frame.error * frame.spent**CONVERGENCE_RATE) ** (1 / (1 + CONVERGENCE_RATE)) for frame in frames]
    order = sorted((f for f in range(len(frames)) if pull[f] > 0), key=lambda f: frames[f].spent / pull[f])
    level = sum_spent = sum_pull = 0.0
    for place, f in enumerate(order):  # Frames join at the level at which their share is 0.
        sum_spent, sum_pull = sum_spent + frames[f].spent, sum_pull + pull[f]
        level = (left + sum_spent) / sum_pull
        if place + 1 < len(order) and level <= frames[order[place + 1]].spent / pull[order[place + 1]]:
            break
    return [max(0.0, pull[f] * level - frame.spent) if pull[f] > 0 else 0.0 for f, frame in enumerate(frames)]


def left_to_target(frames, target):
    """What the frames must get together until the mean of their expected errors is the target."""
    if sum(frame.error for frame in frames) <= target * len(frames):
        return 0.0
    low, high = 0.0, sum(frame.spent for frame in frames)
    while mean_error_after(frames, high) > target:
        high *= 2
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if mean_error_after(frames, middle) > target else (low, middle)
    return high


def mean_error_after(frames, left):
    return sum(f.error_after(share) for f, share in zip(frames, shares_of(frames, left))) / len(frames)


def next_slice(frames, left):
    """(index, round, share) of the frame whose next round lowers the error most for a unit of the budget: what the
    round takes, and what the frame would get in all. None where too little is left for a round, or no error.

    Where some shares are too small for a round, the frames with the smallest ones get nothing, and the others more."""
    chosen = list(range(len(frames)))
    while chosen:
        shares = dict(zip(chosen, shares_of([frames[f] for f in chosen], left)))
        smallest = min(chosen, key=lambda f: shares[f] / frames[f].least)
        if shares[smallest] >= frames[smallest].least:
            break
        if len(chosen) == 1 and shares[smallest] >= MIN_SAMPLES * frames[smallest].price:
            break
        chosen.remove(smallest)
    if not chosen:
        return None
    best = max(chosen, key=lambda f: frames[f].gain)
    share, step = shares[best], frames[best].step
    return best, (share if share <= 2 * step else step), share
